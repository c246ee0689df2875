"""R1 to R6: small systems with closed forms or exact published values, from records of every step.

Numbers: code_aster validation tests (EDF, published with their reference values), recomputed. Each
function takes the record dataset of one run (record.every_step) and returns Checks.
"""

import numpy as np

from evidence.validation.check import Check

SLIDE_EXTREMES_M = (-6.5e-4, 4.5e-4, -2.5e-4, 0.5e-4, 0.5e-4)  # at n pi/100 s; the last is at rest
LAUNCH = {
    "mass_kg": 100.0,
    "speed_m_per_s": 1.0,
    "peak_force_N": 9950.372,
    "peak_time_s": 0.01563001,
    "contact_s": 0.03126002,
    "impulse_N_s": 198.01980,
    "second_maximum_s": 0.36104929,
}
FORCED_CONTACT_S = (
    (0.024867876, 0.025260518),
    (0.046328519, 0.046722721),
    (0.06625224, 0.066645834),
    (0.208191408, 0.208581391),
    (0.236839728, 0.237232929),
    (0.259783891, 0.260177191),
)
FORCED_PEAKS_N = (105794.34, 133098.19, 122220.14)
# Contacts later in the same run, and the peak forces of the fourth to the sixth.
LATE_CONTACT_S = ((1.015647709, 1.016038835), (3.886525493, 3.886916559))
LATE_PEAKS_N = {4: 127595.9, 5: 220953.1, 6: 224392.2}
BASE_DRIVEN_M = {
    0.05: -3.580041e-4,
    0.156: -1.221167e-4,
    0.25: -1.887019e-4,
    0.4: -1.898401e-4,
    0.5: -7.02148e-5,
    1.0: -1.085591e-4,
}
WEAR_W = {15.0: 15.2671, 1.5: 0.409062, 1.01: 2.26164e-4, 0.99: 0.0}  # base acceleration m/s² -> W
FREE_VIBRATION_HZ = {  # energy J -> frequency
    1.0e-3: 0.55688928,
    2.0e-3: 0.59865096,
    6.50108e-3: 0.64663104,
    1.0e-2: 0.65895614,
    0.1: 0.69622115,
}
SDND100, SDND101, SDND121 = "closed form (SDND100)", "closed form (SDND101)", "exact (SDND121)"
SDND122 = "exact (SDND122)"
SDND102, SDND104 = "exact (SDND102)", "published (SDND104)"


def contact_times(record, point=0):
    """Return (contact, 2) s: begin and end of each contact of a point.

    They are interpolated from its force at every step. Before contact the force is zero, so that
    the line through the first two loaded steps is extrapolated back.
    """
    time = record["step_time"].values
    force = np.hypot(*record["contact_force"].values[point])
    loaded = force > 0.0
    begins = np.flatnonzero(loaded[1:] & ~loaded[:-1]) + 1
    ends = np.flatnonzero(~loaded[1:] & loaded[:-1])
    if loaded[0]:
        ends = ends[1:] if len(ends) and len(begins) and ends[0] < begins[0] else ends
    step = time[1] - time[0]
    count = min(len(begins), len(ends))
    touched = np.array([_crossing(time, force, at, -step) for at in begins[:count]])
    left = np.array([_crossing(time, force, at, step) for at in ends[:count]])
    return np.column_stack([touched, left])


def _crossing(time, force, at, step):
    """Return the time at which the force was zero, on the parabola through the next three steps."""
    away = -1 if step > 0.0 else 1
    f0, f1, f2 = force[at], force[at + away], force[at + 2 * away]
    slope, bend = (4.0 * f1 - 3.0 * f0 - f2) / 2.0, (f2 - 2.0 * f1 + f0) / 2.0
    steps = -f0 / slope
    for _ in range(8):
        steps -= (f0 + slope * steps + bend * steps**2) / (slope + 2.0 * bend * steps)
    return time[at] - steps * step


def slide_checks(record):
    """Return the Checks of R1: a mass on a spring that slides to rest.

    Tolerance: 0.1 % of the initial displacement on each extreme.
    """
    time, displacement = record["step_time"].values, record["element_displacement"].values[0]
    checks = []
    for number, extreme in enumerate(SLIDE_EXTREMES_M, start=1):
        ours = np.interp(number * np.pi / 100.0, time, displacement)
        checks.append(
            Check(
                "R1",
                f"displacement at {number} pi/100 s",
                "m",
                extreme,
                SDND100,
                ours,
                1e-3,
                scale=0.85e-3,
            )
        )
    return checks


def launch_checks(record):
    """Return the Checks of R2: a mass launched against a stop, and a second stop out of reach."""
    time = record["step_time"].values
    force = -record["contact_force"].values[0, 0]
    first = np.flatnonzero(force > 0.0)
    last = first[np.flatnonzero(np.diff(first) > 1)[0]] if np.any(np.diff(first) > 1) else first[-1]
    bout = slice(0, last + 2)
    peak, at = _summit(time[bout], force[bout])
    displacement = record["contact_displacement"].values[0, 0]
    rebound = -(displacement[last + 3] - displacement[last + 1]) / (time[last + 3] - time[last + 1])
    left = _crossing(time, force, last, time[1] - time[0])
    checks = [
        Check("R2", "peak force", "N", LAUNCH["peak_force_N"], SDND101, peak, 1e-5),
        Check("R2", "time of the peak", "s", LAUNCH["peak_time_s"], SDND101, at, 1e-4),
        Check("R2", "contact time", "s", LAUNCH["contact_s"], SDND101, left, 1e-4),
        Check(
            "R2",
            "impulse",
            "N s",
            LAUNCH["impulse_N_s"],
            SDND101,
            np.trapezoid(force[bout], time[bout]),
            1e-5,
        ),
        Check("R2", "rebound speed", "m/s", LAUNCH["speed_m_per_s"], SDND101, rebound, 1e-3),
    ]
    later = time > 0.2
    _, at = _summit(time[later], force[later])
    checks.append(
        Check(
            "R2",
            "second maximum of the first stop",
            "s",
            LAUNCH["second_maximum_s"],
            SDND101,
            at,
            1e-4,
        )
    )
    checks.append(
        Check(
            "R2",
            "force of the far stop",
            "N",
            0.0,
            SDND101,
            np.abs(record["contact_force"].values[1]).max(),
            0.0,
            scale=1.0,
        )
    )
    return checks


def _summit(time, force):
    """Return (value, time) of the maximum, on the parabola through its three largest steps."""
    i = int(np.argmax(force))
    before, top, after = force[i - 1 : i + 2]
    shift = 0.5 * (before - after) / (before - 2.0 * top + after)
    return top - 0.25 * (before - after) * shift, time[i] + shift * (time[1] - time[0])


def forced_impact_checks(record):
    """Return the Checks of R3: contact times and peak forces of a mass driven against a stop."""
    ours = contact_times(record)
    duration = FORCED_CONTACT_S[0][1] - FORCED_CONTACT_S[0][0]
    checks = []
    for number, reference in enumerate(FORCED_CONTACT_S):
        for side, expected, found in zip(("in", "out"), reference, ours[number], strict=True):
            checks.append(
                Check(
                    "R3",
                    f"contact {number + 1} {side}",
                    "s",
                    expected,
                    SDND121,
                    found,
                    1e-3,
                    scale=duration,
                )
            )
    time, force = record["step_time"].values, np.abs(record["contact_force"].values[0, 0])
    for number, peak in enumerate(FORCED_PEAKS_N):
        inside = (time > ours[number, 0] - 1e-4) & (time < ours[number, 1] + 1e-4)
        checks.append(
            Check(
                "R3",
                f"peak force {number + 1}",
                "N",
                peak,
                SDND121,
                _summit(time[inside], force[inside])[0],
                1e-4,
            )
        )
    energy = dict(zip(record["run_term"].values, record["run_energy"].values, strict=True))
    balance = energy["mechanical"] + energy["stored"] - energy["input_work"]
    checks.append(
        Check(
            "R3",
            "energy balance at the end",
            "J",
            0.0,
            "conservation",
            balance,
            1e-4,
            scale=_elastic_scale(record),
        )
    )
    return checks


def late_impact_checks(record):
    """Return the Checks of R3 up to 3.9 s, about 70 impacts: contact times and peak forces.

    Tolerance of the times: 0.5 % of a contact's duration.
    """
    ours = contact_times(record)
    duration = FORCED_CONTACT_S[0][1] - FORCED_CONTACT_S[0][0]
    checks = []
    for reference in LATE_CONTACT_S:
        found = ours[np.argmin(np.abs(ours[:, 0] - reference[0]))]
        checks += [
            Check("R3", f"contact near {t:.4g} s, {side}", "s", t, SDND121, at, 5e-3, duration)
            for side, t, at in zip(("in", "out"), reference, found, strict=True)
        ]
    time, force = record["step_time"].values, np.abs(record["contact_force"].values[0, 0])
    for number, peak in LATE_PEAKS_N.items():
        begin, end = ours[number - 1]
        inside = (time > begin - 1e-4) & (time < end + 1e-4)
        top = _summit(time[inside], force[inside])[0]
        checks.append(Check("R3", f"peak force {number}, long run", "N", peak, SDND121, top, 1e-4))
    return checks


def free_vibration_checks(record):
    """Return the Checks of R6: frequency of a mass on a spring against one stop, by its energy.

    Each mass of the run has one of the energies. The frequency is that of its passages through 0
    towards the stop.
    """
    time, displacement = record["step_time"].values, record["contact_displacement"].values[:, 0]
    return [
        Check(
            "R6",
            f"frequency at {energy:g} J",
            "Hz",
            reference,
            SDND122,
            _frequency(time, displacement[number]),
            1e-6,
        )
        for number, (energy, reference) in enumerate(FREE_VIBRATION_HZ.items())
    ]


def _frequency(time, displacement):
    """Return the mean frequency in Hz of the passages through 0 upwards, linear between steps."""
    before = np.flatnonzero((displacement[:-1] < 0.0) & (displacement[1:] >= 0.0))
    share = displacement[before] / (displacement[before] - displacement[before + 1])
    passages = time[before] + share * (time[1] - time[0])
    return (len(passages) - 1) / (passages[-1] - passages[0])


def _elastic_scale(record):
    """Return the largest energy that the stop stored, which is the energy of an impact."""
    force, depth = record["contact_force"].values[0, 0], record["contact_displacement"].values[0, 0]
    at = int(np.argmax(np.abs(force)))
    return 0.5 * abs(force[at]) * (depth[at] - 1e-3)


def contact_time_error(record):
    """Return the RMS error in s of R3's contact times."""
    return float(
        np.sqrt(np.mean((contact_times(record)[: len(FORCED_CONTACT_S)] - FORCED_CONTACT_S) ** 2))
    )


def contact_time_order(records):
    """Return (step (run,) s, error (run,) s, order) of R3's contact times.

    error: RMS. order: slope of its logarithm against that of the step.
    """
    steps = np.array([1.0 / record.attrs["steps_per_second"] for record in records])
    errors = np.array([contact_time_error(record) for record in records])
    return steps, errors, float(np.polyfit(np.log(steps), np.log(errors), 1)[0])


def base_driven_checks(record):
    """Return the Checks of R4: displacement of a mass on a moving base, against a fixed wall."""
    time, displacement = record["step_time"].values, record["contact_displacement"].values[0, 0]
    largest = max(map(abs, BASE_DRIVEN_M.values()))
    return [
        Check(
            "R4",
            f"absolute displacement at {at:g} s",
            "m",
            reference,
            SDND102,
            np.interp(at, time, displacement),
            1e-4,
            scale=largest,
        )
        for at, reference in BASE_DRIVEN_M.items()
    ]


def wear_checks(records, stick_stiffness):
    """Return the Checks of R5: wear work rate of a mass on a plane whose base shakes.

    records: one per base acceleration of WEAR_W, in its order; stick_stiffness N/m of the slider.
    Work rate: normal force (slider force over mu = 0.1) times slip speed, mean over 4 to 12 s.
    """
    return [
        Check(
            "R5",
            f"work rate at {acceleration:g} m/s2",
            "W",
            reference,
            SDND104,
            wear_rate(record, stick_stiffness),
            1e-3,
            scale=reference or WEAR_W[1.01],
        )
        for (acceleration, reference), record in zip(WEAR_W.items(), records, strict=True)
    ]


def wear_rate(record, stick_stiffness, friction=0.1, window=(4.0, 12.0)):
    """Return the wear work rate in W: normal force times slip speed, mean over `window` s.

    Slip is the displacement less the elongation of the stick spring, whose force is the element's.
    """
    time = record["step_time"].values
    force = record["element_force"].values[0]
    displacement = record["element_displacement"].values[0]
    inside = (time >= window[0]) & (time <= window[1])
    slip = np.diff(displacement + force / stick_stiffness)[inside[1:]]
    return float(
        np.sum(np.abs(force[1:][inside[1:]]) / friction * np.abs(slip)) / (window[1] - window[0])
    )
