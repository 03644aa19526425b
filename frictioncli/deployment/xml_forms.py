"""URDF and MuJoCo's MJCF: the simple form of friction, with what it loses in a comment."""

from collections.abc import Sequence
from textwrap import fill
from xml.sax.saxutils import quoteattr

from frictioncli.deployment.simplified_friction import SimpleForm

_URDF = """\
<?xml version="1.0" encoding="UTF-8"?>
<!--
{comment}
  The robot around it is only there so that the file loads: copy the line <dynamics .../> into the
  joint of yours.
-->
<robot name="friction_of_one_joint">
  <link name="base"/>
  <link name="arm">
    <inertial>
      <mass value="1"/>
      <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>
    </inertial>
  </link>
  <joint name={name} type="continuous">
    <parent link="base"/>
    <child link="arm"/>
    <axis xyz="0 0 1"/>
    <dynamics damping="{damping!r}" friction="{dry!r}"/>
  </joint>
</robot>
"""

_MJCF = """\
<?xml version="1.0" encoding="UTF-8"?>
<!--
{comment}
  To use it: <include file="THIS FILE"/> in your model, and class={name} at the joint.
-->
<mujoco>
  <default>
    <default class={name}>
      <joint damping="{damping!r}" frictionloss="{dry!r}"/>
    </default>
  </default>
</mujoco>
"""


def urdf(form: SimpleForm, name: str, remarks: Sequence[str]) -> str:
    """Return a URDF whose only joint has the friction; the remarks stand in its head."""
    return _filled(_URDF, form, name, remarks)


def mjcf(form: SimpleForm, name: str, remarks: Sequence[str]) -> str:
    """Return an MJCF file to include: a default class for the joint."""
    return _filled(_MJCF, form, name, remarks)


def _filled(template: str, form: SimpleForm, name: str, remarks: Sequence[str]) -> str:
    # two hyphens would end a comment of XML
    comment = "\n".join(
        fill(line, width=98, initial_indent="  ", subsequent_indent="    ", drop_whitespace=True)
        for line in remarks
    ).replace("--", "- -")
    return template.format(
        comment=comment, name=quoteattr(name), damping=form.damping, dry=form.dry
    )
