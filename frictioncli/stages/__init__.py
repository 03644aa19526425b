"""The stages of the analysis on a work folder, one module per command.

``frictioncli fit -w RUN`` is ``frictioncli.stages.fit.fit(Path("RUN"))``: a stage reads tables of
the work folder and writes its own. It returns what the command prints. All stages in a row are
:func:`frictioncli.stages.run.run`.

The commands without a work folder call other packages: ``inspect`` is
:func:`frictioncli.inspection.inspect.inspect`, ``synthesize`` is
:func:`frictioncli.simulator.synthesize.synthesize`, and ``fleet``, which runs the stages for many
joints, is :func:`frictioncli.fleet.fleet.run_fleet`.
"""
