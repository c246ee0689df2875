"""The output filter in compiled form: its first stage inside the integration, its second after it.

The first stage divides the rate by ``RATIO``. A *tick* is RATIO steps, a *phase* the number of a
step within its tick. A step adds to ``SLOTS`` outputs at once; their sums are in State.filter_sums,
for the modes, then the supports' resultants, then the drive forces.
"""

from .compiled import entry_point, inlined
from .lanes import LANES, add_to, clear, fetch_to_write, fma, load, spread, spread_from, store
from .panels import (
    PANEL,
    ROWS,
    TILE,
    load_tile,
    plus_dots,
    rows_zero,
    store_tile,
    tile_plus_common,
)

RATIO = 5  # decimation of the first stage
SLOTS = 6  # outputs of the first stage that one step contributes to
BEHIND = SLOTS // 2 - 1  # ticks from the centre of an output to the step that completes it
CHANNEL_BLOCK = PANEL // 2  # entries of a group come in multiples of it, whatever ROWS is


@inlined
def filter_modes(modal, state, output, tick):
    """Add the modal displacements of the RATIO steps of a tick to the first filter stage."""
    modes = modal.mode_start[-1]
    width = state.filter_sums.size // (SLOTS * LANES)
    for g in range(modal.mode_start.size - 1):
        if state.group_active[g] == 0:
            continue
        for i in range(modal.mode_start[g], modal.mode_start[g + 1], TILE):
            for slot in range(SLOTS):
                at = ((tick + slot) % SLOTS) * width + i
                total = load_tile(state.filter_sums, at)
                for phase in range(RATIO):
                    weight = spread(output.weights[phase, slot])
                    q = load_tile(state.q, phase * modes + i)
                    total = tile_plus_common(weight, q, total)
                store_tile(state.filter_sums, at, total)


@inlined
def filter_forces(modal, state, output, work, drive, first, forces, touched, phase, tick):
    """Add the supports' resultants and the drive forces of a step (``forces`` of them, from vector
    ``first`` of drive) to the first filter stage.
    """
    width = state.filter_sums.size // (SLOTS * LANES)
    sums = state.filter_sums
    for slot in range(SLOTS):
        a = ((tick + slot) % SLOTS) * width + modal.mode_start[-1]
        w = spread(output.weights[phase, slot])
        if touched:
            for c in range(2 * output.supports):
                store(sums, a + c, fma(w, load(work.resultant, c), load(sums, a + c)))
        a += 2 * output.supports
        for c in range(forces):
            store(sums, a + c, fma(w, load(drive, first + c), load(sums, a + c)))


@inlined
def project_channels(modal, g, output, array, base, entries, channels):
    """Add the modes of group g, in ``array`` from vector ``base`` on, to the output channels of
    ``entries`` (first, end), ROWS at a time.
    """
    first = modal.mode_start[g]
    width = modal.mode_start[g + 1] - first
    for e in range(entries[0], entries[1], ROWS):
        at, sums = output.shape_start[e], rows_zero()
        for i in range(0, width, PANEL):
            sums = plus_dots(output.shapes, at + i, width, array, base + first + i, sums)
        for k in range(ROWS):
            add_to(channels, output.channel[e + k], sums[k])


@inlined
def finish_output(modal, state, output, tick, at_tick, channels):
    """Write the oldest output of the first stage to output.values and clear its sums."""
    modes = modal.mode_start[-1]
    width = state.filter_sums.size // (SLOTS * LANES)
    base = (tick % SLOTS) * width
    column = output.column + at_tick
    ahead = min(column + 1, output.columns - 1)
    clear(channels)
    for g in range(modal.mode_start.size - 1):
        if state.group_active[g] == 0:
            continue
        entries = (output.channel_start[g], output.stress_entry[g])
        project_channels(modal, g, output, state.filter_sums, base, entries, channels)
    for c in range(output.stress_start):
        fetch_to_write(output.values, c * output.columns + ahead)
        store(output.values, c * output.columns + column, load(channels, c))
    for x in range(width - modes):
        at = (output.stress_start + x) * output.columns
        fetch_to_write(output.values, at + ahead)
        store(output.values, at + column, load(state.filter_sums, base + modes + x))
    for x in range(width):
        store(state.filter_sums, base + x, 0.0)


@entry_point
def decimate(values, taps, out, out_start, step, buffer):
    """Second stage of the output filter, lane by lane, four samples at a time.

    ``values`` (channel, tick, lane) flat with ``taps.size - 1`` ticks of history in front; ``taps``
    padded with 3 step zeros at both ends; ``out`` (lane, channel, sample) receives sample j = sum
    of taps times values from tick j * step on, at ``out_start + j``; buffer (4, lane).
    """
    lanes, channels, _ = out.shape
    ticks = values.size // (channels * LANES)
    length = taps.size - 6 * step
    count = (ticks - length) // step + 1
    for c in range(channels):
        for j in range(0, count, 4):
            at = c * ticks + j * step
            a, b, d, e = spread(0.0), spread(0.0), spread(0.0), spread(0.0)
            for k in range(min(length + 3 * step, ticks - j * step)):
                value = load(values, at + k)
                a = fma(spread_from(taps, k + 3 * step), value, a)
                b = fma(spread_from(taps, k + 2 * step), value, b)
                d = fma(spread_from(taps, k + step), value, d)
                e = fma(spread_from(taps, k), value, e)
            store(buffer, 0, a)
            store(buffer, 1, b)
            store(buffer, 2, d)
            store(buffer, 3, e)
            for m in range(min(4, count - j)):
                for lane in range(lanes):
                    out[lane, c, out_start + j + m] = buffer[m, lane]
