"""URDF and MJCF files with simplified friction; comments state what it cannot hold."""

from collections.abc import Sequence
from textwrap import fill
from xml.sax.saxutils import quoteattr

from frictioncli.deployment.simplified_friction import SimplifiedFriction

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


def urdf_text(friction: SimplifiedFriction, name: str, remarks: Sequence[str]) -> str:
    """Return a URDF with one joint that has the friction, and remarks as a comment."""
    return _fill(_URDF, friction, name, remarks)


def mjcf_text(friction: SimplifiedFriction, name: str, remarks: Sequence[str]) -> str:
    """Return an MJCF file to include, with a default class for the joint."""
    return _fill(_MJCF, friction, name, remarks)


def _fill(template: str, friction: SimplifiedFriction, name: str, remarks: Sequence[str]) -> str:
    # two hyphens are not allowed in an XML comment
    comment = "\n".join(
        fill(line, width=98, initial_indent="  ", subsequent_indent="    ", drop_whitespace=True)
        for line in remarks
    ).replace("--", "- -")
    return template.format(
        comment=comment, name=quoteattr(name), damping=friction.damping, dry=friction.dry
    )
