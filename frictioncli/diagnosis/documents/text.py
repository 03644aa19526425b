"""The result of a diagnosis in plain words."""

from frictioncli.diagnosis.diagnose import Diagnosis


def verdict_text(diagnosis: Diagnosis) -> str:
    """Return what is wrong, where, why we think so, what it is worth, what to measure next."""
    unit = diagnosis.torque_unit
    lines = [
        f"joint {diagnosis.joint}: {diagnosis.verdict}; the simulated torque misses the measured"
        f" one by {diagnosis.rmse:.3g} {unit} (RMS)"
    ]
    for cause in diagnosis.causes:
        effect = cause.fit.effect
        shares = ", ".join(
            f"{name} {cause.probabilities.get(name, 0.0):.0%}" for name in cause.effects
        )
        lines.append(
            f"  {' or '.join(cause.effects)} ({shares}): {effect.summary} {cause.size:.2g} {unit}"
            f" RMS in the {effect.channel}, chance {cause.test.p_value:.1g}"
        )
        lines.append(f"    seen: {effect.signature.claim}")
        lines.append(f"    next: {effect.experiment}")
    if diagnosis.structure is not None:
        left = diagnosis.structure
        lines.append(
            f"  structure that no effect of the catalogue explains: along {left.axis}, in the"
            f" {left.channel}, {left.size:.2g} {unit} RMS, chance {left.p_value:.1g}"
        )
    for cause in diagnosis.visible:
        lines.append(
            f"  {' or '.join(cause.effects)}: stands out of the noise ({cause.size:.2g} {unit} RMS,"
            f" chance {cause.test.p_value:.1g}), but is not worth modelling"
        )
    if not diagnosis.causes and diagnosis.structure is None:
        lines.append(f"  no cause found; {_silence(diagnosis)}")
    if diagnosis.gain is not None:
        lines.append(f"  {_gain_text(diagnosis)}")
    return "\n".join(lines)


def _gain_text(diagnosis: Diagnosis) -> str:
    gain, unit = diagnosis.gain, diagnosis.torque_unit
    assert gain is not None  # only asked where something was found
    where = (
        f"on run {diagnosis.held_out}, new to the extension"
        if gain.basis == "new_run"
        else "within the same run, which flatters"
    )
    return (
        f"extended model: {gain.before:.3g} -> {gain.after:.3g} {unit} {where}, a gain of"
        f" {gain.reduction:.0%} ({gain.interval[0]:.0%} to {gain.interval[1]:.0%}); noise floor"
        f" {gain.floor:.2g} {unit}"
    )


def _silence(diagnosis: Diagnosis) -> str:
    sizes = [(size, name) for name, size in diagnosis.detectable.items() if size is not None]
    if not sizes:
        return "the data can show none of the effects"
    least, most = min(sizes), max(sizes)
    return (
        f"an effect would have been found four times in five from {least[0]:.2g}"
        f" ({least[1]}) to {most[0]:.2g} {diagnosis.torque_unit} RMS ({most[1]})"
    )
