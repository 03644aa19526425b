"""The stages on a work folder, one module per command: each reads tables and writes its own.

``frictioncli fit -w RUN`` is ``frictioncli.stages.fit.fit(Path("RUN"))``. What a stage returns
prints as that command's output. All stages in a row: :mod:`frictioncli.stages.run`.
"""
