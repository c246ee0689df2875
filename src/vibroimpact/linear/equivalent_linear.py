"""The linear tube with an equivalent support: frequencies, first pole and shape, frequency
responses and records.

The equivalent support is bilateral: stiffness k [N/m] and damping c [N s/m] per support, shared by
its contact points with their weights, alike in both transverse directions and at every support. On
the modes, with W = sum_points weight sum_directions b b^T and b the contact shapes, the stiffness
is diag(omega²) + k W and the damping diag(damping) + c W: k = c = 0 is the tube without contact.
"""

import numpy as np
from scipy import linalg

from vibroimpact.units import TIME_DERIVATIVES

POLE_TOLERANCE = 1.0e-12
# a Newton step below this that no longer shrinks is round-off: very stiff supports do not reach
# 1e-12
POLE_ROUND_OFF = 1.0e-7
CONTINUATION_STEP = 0.02  # largest relative change of the pole predicted for one step in c
MAX_NEWTON_PASSES = 12
FREQUENCY_CHUNK = 4096


def contact_matrix(model):
    """Return B (mode, contact_row) in kg^-1/2, W = B B^T: contact shapes times the square root of
    the weights, a row per direction.
    """
    return (model.contact_shapes * np.sqrt(model.contact_weight)[None, :, None]).reshape(
        model.modes, -1
    )


def natural_frequencies(model, k, count):
    """Return (count,) lowest undamped frequencies in Hz with support stiffness k in N/m; fewer when
    the model has fewer modes.
    """
    contact = contact_matrix(model)
    squares = []
    for modes, _ in model.blocks:
        squares.append(np.linalg.eigvalsh(_stiffness(model.omega[modes], contact[modes], k)))
    lowest = np.sort(np.concatenate(squares))[:count]
    return np.sqrt(np.maximum(lowest, 0.0)) / (2.0 * np.pi)


def first_block(model, channel=0):
    """Return (mode,) indices of the block in which the drive does most: where its static
    displacement under a unit force is largest.

    For a tube driven across its plane these are the out-of-plane modes. Raises ValueError when the
    drive moves no contact.
    """
    blocks = [modes for modes, contacts in model.blocks if contacts]
    static = [
        np.sum((model.drive_shapes[modes, channel] / np.maximum(model.omega[modes], 1.0)) ** 2)
        for modes in blocks
    ]
    if not blocks or max(static) == 0.0:
        raise ValueError(
            f"force channel {channel} moves no contact point: no support stiffness can be seen"
            " from it"
        )
    return blocks[int(np.argmax(static))]


def first_mode_shape(model, k, shapes=None):
    """Return (output,) the first mode of the driven block with support stiffness k in N/m, read by
    `shapes` (mode, output).

    shapes defaults to model.line_shapes. Unit modal mass (kg^-1/2); the largest component is
    positive.
    """
    modes = first_block(model)
    _, vector = _first_mode(model, modes, k)
    shape = (model.line_shapes if shapes is None else shapes)[modes].T @ vector
    return shape if shape[np.argmax(np.abs(shape))] > 0.0 else -shape


def first_pole(model, k, c):
    """Return the pole (complex, rad/s, positive imaginary part) of the first mode of the driven
    block with support (k N/m, c N s/m).

    Followed from c = 0, where it is the lowest mode, so that it stays the same mode where damping
    makes poles cross or overdamps others. Frequency in Hz is |pole| / (2 pi), damping ratio
    -Re(pole) / |pole|.

    Raises ValueError when it cannot be followed to c (the message says how far it went), or k
    leaves the tube unstable.
    """
    return _follow_first_mode(model, k, c)[0]


def pole_sensitivity(model, k, c):
    """Return (d pole / dk in rad/s per N/m, d pole / dc in rad/s per N s/m), complex, of
    `first_pole` at (k, c).
    """
    pole, vector, modes = _follow_first_mode(model, k, c)
    contact = contact_matrix(model)[modes]
    slope = _pole_slope(model.damping[modes], contact, c, pole, vector)
    return slope, pole * slope


def support_from_pole(model, pole):
    """Return (k in N/m, c in N s/m) of the support that gives the first mode of the driven block
    this `pole` (complex, rad/s).

    Exact, the inverse of `first_pole`: a pole is where I + (k + pole c) G(pole) is singular, G =
    B^T (pole² + pole damping + omega²)^-1 B being the contact compliance of the tube without
    support, so that k + pole c = -1/eigenvalue of G(pole).

    Raises ValueError when no support gives the first mode this pole (above the clamped frequency,
    for example).
    """
    if pole.imag <= 0.0:
        raise ValueError(f"pole {pole} rad/s must have a positive imaginary part")
    modes = first_block(model)
    contact = contact_matrix(model)[modes]
    dynamic = pole**2 + pole * model.damping[modes] + model.omega[modes] ** 2
    flexibility = linalg.eigvals((contact.T / dynamic) @ contact)
    supports = -1.0 / flexibility[np.abs(flexibility) > 1.0e-14 * np.abs(flexibility).max()]
    damping = supports.imag / pole.imag
    stiffness = supports.real - pole.real * damping
    # The stable choice comes first: a positive stiffness, then the smallest support that does it.
    order = np.lexsort((np.abs(supports), stiffness < 0.0))
    for k, c in zip(stiffness[order], damping[order], strict=True):
        try:
            if abs(first_pole(model, k, c) - pole) < 1.0e-6 * abs(pole):
                return float(k), float(c)
        except ValueError:
            # this candidate belongs to another mode, or lies where the first one cannot be followed
            continue
    raise ValueError(
        f"no support gives the first mode the pole {pole:.6g} rad/s"
        f" ({abs(pole) / (2.0 * np.pi):.4g} Hz)"
    )


def frf(model, k, c, frequency, output_shapes, kind="displacement", channel=0):
    """Return (output, frequency) complex response per N of force channel `channel` with support (k
    N/m, c N s/m).

    frequency: (frequency,) Hz; output_shapes: (mode, output); kind: displacement (m), velocity
    (m/s) or acceleration (m/s²).
    """
    frequency = np.atleast_1d(np.asarray(frequency, dtype=float))
    response = np.empty((output_shapes.shape[1], len(frequency)), dtype=complex)
    for first in range(0, len(frequency), FREQUENCY_CHUNK):
        part = slice(first, first + FREQUENCY_CHUNK)
        laplace = 2j * np.pi * frequency[part]
        free, compliance, reached, seen = _contact_view(model, laplace, output_shapes, channel)
        support = (k + laplace * c)[:, None, None]
        force = np.linalg.solve(
            np.eye(compliance.shape[-1]) + support * compliance, support * reached[..., None]
        )[..., 0]
        response[:, part] = (
            free - np.einsum("fop,fp->fo", seen, force)
        ).T * laplace ** TIME_DERIVATIVES[kind]
    return response


def psd_family(model, k_grid, c_grid, frequency, shape, kind="displacement", channel=0):
    """Return (k, c, frequency) squared magnitude of the response per N: the PSD for a force of unit
    one-sided PSD.

    k_grid (k,) N/m; c_grid (c,) N s/m; frequency (frequency,) Hz; shape (mode,) the output. Unit
    (m/N)², (m/s/N)² or (m/s²/N)².

    With G = V diag(l) V^-1 the contact compliance at one frequency and s = k + i omega c, the
    response h - a^T s (I + s G)^-1 b is h - sum_j (a V)_j (V^-1 b)_j s / (1 + s l_j): one
    eigenvalue problem per frequency serves all (k, c).
    """
    frequency = np.asarray(frequency, dtype=float)
    laplace = 2j * np.pi * frequency
    free, compliance, reached, seen = _contact_view(
        model, laplace, np.asarray(shape)[:, None], channel
    )
    flexibility, vectors = np.linalg.eig(compliance)
    share = np.linalg.solve(vectors, reached[..., None])[..., 0] * np.einsum(
        "fp,fpj->fj", seen[:, 0], vectors
    )
    support = (
        np.asarray(k_grid, dtype=float)[:, None, None]
        + np.asarray(c_grid, dtype=float)[None, :, None] * laplace
    )
    response = np.broadcast_to(free[:, 0], support.shape).copy()
    for term in range(flexibility.shape[1]):
        response -= share[:, term] * support / (1.0 + support * flexibility[:, term])
    return (response.real**2 + response.imag**2) * np.abs(laplace) ** (2 * TIME_DERIVATIVES[kind])


def synthesise_records(
    model,
    k,
    c,
    force,
    sampling_frequency=2048.0,
    output_shapes=None,
    kind="displacement",
    channel=0,
):
    """Return (output, time) response in m (m/s, m/s²) of the linear tube with support (k, c) to the
    periodic `force` (time,) in N.

    Exact for a force that repeats after its length and has nothing above half the
    sampling_frequency in Hz: every line of its spectrum is multiplied by the FRF. Cut a stretch out
    of a longer record where a response without period is wanted. output_shapes: (mode, output),
    model.sensor_shapes when left out.
    """
    output_shapes = model.sensor_shapes if output_shapes is None else output_shapes
    lines = np.fft.rfft(force)
    frequency = np.fft.rfftfreq(len(force), 1.0 / sampling_frequency)
    return np.fft.irfft(
        frf(model, k, c, frequency, output_shapes, kind, channel) * lines, n=len(force)
    )


def _stiffness(omega, contact, k):
    """Return (mode, mode) diag(omega²) + k B B^T."""
    return np.diag(omega**2) + k * contact @ contact.T


def _first_mode(model, modes, k):
    """Return (omega rad/s, vector (mode,)) of the lowest mode with support stiffness k in N/m,
    within a block.

    Raises ValueError when the tube does not vibrate on it: a free tube without support, or a
    negative k that it buckles under.
    """
    square, vector = linalg.eigh(
        _stiffness(model.omega[modes], contact_matrix(model)[modes], k), subset_by_index=[0, 0]
    )
    if square[0] <= 0.0:
        raise ValueError(
            f"with a support stiffness of {k:.6g} N/m the tube has no lowest frequency above 0"
        )
    return np.sqrt(square[0]), vector[:, 0]


def _follow_first_mode(model, k, c):
    """Return (pole rad/s, vector (mode,) complex, modes (mode,)) of the first mode of the driven
    block, followed from c = 0.
    """
    modes = first_block(model)
    contact, damping = contact_matrix(model)[modes], model.damping[modes]
    stiffness = _stiffness(model.omega[modes], contact, k)
    omega, vector = _first_mode(model, modes, k)
    start = -0.5 * vector @ (damping * vector) + 1j * omega
    pole, vector = _refine_pole(stiffness, damping, contact, 0.0, start, vector.astype(complex))
    reached, step = 0.0, c
    while reached != c:
        slope = pole * _pole_slope(damping, contact, reached, pole, vector)
        limit = CONTINUATION_STEP * abs(pole) / max(abs(slope), 1.0e-300)
        step = np.sign(c) * min(abs(step), limit, abs(c - reached))
        target = c if abs(step) == abs(c - reached) else reached + step
        try:
            pole, vector = _refine_pole(
                stiffness, damping, contact, target, pole + slope * step, vector
            )
        except ValueError:
            step *= 0.5
            if abs(step) < 1.0e-6 * abs(c):
                raise ValueError(
                    f"the first pole at k = {k:.6g} N/m was followed to c = {reached:.6g} N s/m,"
                    f" not to {c:.6g}"
                ) from None
            continue
        reached, step = target, 2.0 * step
    return pole, vector, modes


def _refine_pole(stiffness, damping, contact, c, pole, vector):
    """Return (pole, vector (mode,)) with (pole² + pole (diag(damping) + c W) + stiffness) vector =
    0, by Newton from a guess.

    Raises ValueError when Newton does not settle, or lands far (over 5 %) from the guess: that
    would be another mode.
    """
    guess, norm = pole, vector.conj() / np.vdot(vector, vector)
    matrix = np.diag(damping) + c * contact @ contact.T
    size = len(damping)
    # Rows and columns are divided by the frequencies: residual vectors are 1e4 times stiffer than
    # the first mode.
    scale = 1.0 / np.sqrt(np.diag(stiffness))
    bordered = np.zeros((size + 1, size + 1), dtype=complex)
    bordered[size, :size] = norm * scale
    step = np.inf
    for _ in range(MAX_NEWTON_PASSES):
        slope = 2.0 * pole * vector + matrix @ vector
        bordered[:size, :size] = scale[:, None] * (pole * matrix + stiffness) * scale
        bordered[np.arange(size), np.arange(size)] += pole**2 * scale**2
        bordered[:size, size] = scale * slope
        change = np.linalg.solve(
            bordered, np.append(np.zeros(size), 1.0)
        )  # of the new vector (scaled) and of the pole
        vector, pole = scale * change[:size], pole + change[size]
        before, step = step, abs(change[size]) / abs(pole)
        if step < POLE_TOLERANCE or 0.5 * before < step < POLE_ROUND_OFF:
            break
    else:
        raise ValueError("Newton did not settle on a pole")
    if abs(pole - guess) > 0.05 * abs(guess):
        raise ValueError("Newton went to another pole")
    return pole, vector


def _pole_slope(damping, contact, c, pole, vector):
    """Return d pole / d support (rad/s per N/m) for a support s = k + pole c, from the symmetric
    quadratic eigenvalue problem.
    """
    moved = contact.T @ vector
    strength = moved @ moved
    return -strength / (vector @ ((2.0 * pole + damping) * vector) + c * strength)


def _contact_view(model, laplace, output_shapes, channel):
    """Return what contact forces need to know of the tube without support at `laplace` (frequency,)
    = i omega in rad/s.

    (free (frequency, output) m/N response to the drive, compliance (frequency, contact_row,
    contact_row) m/N at the contacts, reached (frequency, contact_row) m/N contact displacement per
    unit drive, seen (frequency, output, contact_row) m/N output per unit contact force). Only
    blocks and contact rows that the drive moves are kept.
    """
    driven = [
        modes for modes, _ in model.blocks if np.any(model.drive_shapes[modes, channel] != 0.0)
    ]
    modes = np.sort(np.concatenate(driven)) if driven else np.zeros(0, dtype=int)
    contact = contact_matrix(model)[modes]
    contact = contact[:, (contact != 0.0).any(axis=0)]
    drive, outputs = model.drive_shapes[modes, channel], output_shapes[modes]
    receptance = 1.0 / (
        laplace[:, None] ** 2 + laplace[:, None] * model.damping[modes] + model.omega[modes] ** 2
    )
    rows = contact.shape[1]
    count = outputs.shape[1]
    pairs = (contact[:, :, None] * contact[:, None, :]).reshape(len(modes), rows * rows)
    seen = (outputs[:, :, None] * contact[:, None, :]).reshape(len(modes), count * rows)
    return (
        receptance @ (drive[:, None] * outputs),
        (receptance @ pairs).reshape(len(laplace), rows, rows),
        receptance @ (drive[:, None] * contact),
        (receptance @ seen).reshape(len(laplace), count, rows),
    )
