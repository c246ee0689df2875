"""The tables that the compiled functions work on: parameters, state, sums and work space.

Shapes are given in axis names. Every array with a lane axis is contiguous and ends in it. A *row*
is one scalar generalised displacement of a group of modes: a direction of a contact point, the
direction of a local element, or a force channel.
"""

from typing import NamedTuple

import numpy as np

# Indices of State.counter
STEPS_WITHOUT_FORCE = 0  # since a contact or an element last bore a force, at most QUIET
STEPS_DONE = 1
QUIET = 2  # steps without a force after which every force kept from earlier steps is zero


class Modal(NamedTuple):
    """The modes, in uncoupled groups (in plane, out of plane), each padded to whole panels.

    The rows of a group are its contact directions, then its local elements, then its force
    channels. ``shapes`` holds for each group, from ``shape_start`` on, an array (panel, row, mode
    of the panel), flat, in the order in which a step reads it; ``acting_shapes`` the same of the
    modes that a force on the row moves, if they are not all; ``row_compliance`` in the same way a
    (displaced row, row with force) matrix.

    If each lane has a model of its own, shapes, acting_shapes, row_compliance, the coefficients of
    the modes and Output.shapes have a last axis of lanes.
    """

    dt: float  # s
    mode_start: np.ndarray  # (group + 1,) first mode of each group, multiples of PANEL
    row_start: np.ndarray  # (group + 1,) first row of each group
    force_row_start: np.ndarray  # (group,) first row of each group that is a force channel
    row_force_channel: np.ndarray  # (row,) force channel of the row, -1 for other rows
    shapes: np.ndarray  # flat [kg^-1/2]
    acting_shapes: np.ndarray  # flat [kg^-1/2]
    shape_start: np.ndarray  # (group,)
    mode_compliance: np.ndarray  # (mode,) this and the next five: see modal_step.StepCoefficients
    force_shift: np.ndarray  # (mode,)
    decay: np.ndarray  # (mode,)
    restoring: np.ndarray  # (mode,)
    force_gain: np.ndarray  # (mode,)
    damping_over_dt: np.ndarray  # (mode,) energy dissipated in a step per dq²
    velocity_weights: np.ndarray  # (4,) see row_velocity
    row_compliance: np.ndarray  # flat [m/N], end-of-step displacement per force there
    compliance_start: np.ndarray  # (group,)
    # Of one run, whose vectors lie along blocks of PANEL rows, padded with zeros; else empty:
    block_shapes: np.ndarray  # flat, of each group (panel, block, mode of the panel, row)
    block_shape_start: np.ndarray  # (group,)
    block_compliance: np.ndarray  # flat, of each group (block, row with force, displaced row)
    block_compliance_start: np.ndarray  # (group,)


class Contact(NamedTuple):
    """The elastic circular obstacle at each contact point."""

    row_1: np.ndarray  # (point,) row of the first transverse direction
    row_2: np.ndarray  # (point,) row of the second
    support: np.ndarray  # (point,) support the point belongs to, in ascending order
    stiffness: np.ndarray  # (point, lane) N/m
    gap: np.ndarray  # (point, lane) m
    offset_1: np.ndarray  # (point, lane) m, centre of the obstacle
    offset_2: np.ndarray  # (point, lane) m
    plain: np.ndarray  # (point,) 1: nothing but this obstacle; 0: see Laws
    tolerance: float  # relative change of the contact forces at which the iteration ends
    max_passes: int
    limit: float  # m, a displacement beyond it means that the run has diverged


class Laws(NamedTuple):
    """Contact laws beyond the elastic circle, one per special point or flat land, then elements.

    A special point has an infinite gap in Contact, so that its elastic circle is never touched.
    """

    contact_point: np.ndarray  # (law,)
    land: np.ndarray  # (law,) its place in Tally.land_work, with lobes the first one; -1: none
    flat: np.ndarray  # (law,) 1: a flat land with the normal below; 0: round the centre
    normal_1: np.ndarray  # (law, lane)
    normal_2: np.ndarray  # (law, lane)
    lobes: np.ndarray  # (law,) number of lobes, 0: a circle
    lobe_depth: np.ndarray  # (law, lane) m
    lobe_cosine: np.ndarray  # (law, lane) of the lobes' angle
    lobe_sine: np.ndarray  # (law, lane)
    gap: np.ndarray  # (law, lane) m
    stiffness: np.ndarray  # (law, lane) N/m, 0 if the law is Hertz's
    hertz: np.ndarray  # (law, lane) N/m^1.5
    hunt_crossley: np.ndarray  # (law, lane) s/m
    damping: np.ndarray  # (law, lane) N s/m
    friction: np.ndarray  # (law, lane) Coulomb coefficient
    stick_stiffness: np.ndarray  # (law, lane) N/m
    stick_flexibility: np.ndarray  # (law, lane) m/N, its inverse, 0 without friction
    element_row: np.ndarray  # (element,)
    element_stiffness: np.ndarray  # (element, lane) N/m
    quadratic: np.ndarray  # (element, lane) N/m²
    cubic: np.ndarray  # (element, lane) N/m³
    element_damping: np.ndarray  # (element, lane) N s/m
    damping_limit: np.ndarray  # (element, lane) N, infinite for a damper without a limit
    drag: np.ndarray  # (element, lane) N s²/m²
    partner_row: np.ndarray  # (element,) row whose velocity counts in the drag too, -1: none
    slider_stiffness: np.ndarray  # (element, lane) N/m
    slider_flexibility: np.ndarray  # (element, lane) m/N, its inverse, 0 without a slider
    slip_limit: np.ndarray  # (element, lane) N
    saturation_stiffness: np.ndarray  # (element, lane) N/m
    saturation_limit: np.ndarray  # (element, lane) N


class State(NamedTuple):
    """The values that one step hands to the next. Modal displacements are in m kg^1/2."""

    q: np.ndarray  # (RATIO, mode, lane) of the last RATIO steps; step n at index n % RATIO
    q_next_free: np.ndarray  # (mode, lane) at the end of the next step without a force there
    dq: np.ndarray  # (mode, lane) increment that leads to q_next_free
    group_active: np.ndarray  # (group,) int64: 0 while nothing has moved the group's modes
    row_displacement: np.ndarray  # (row, lane) m
    row_displacement_before: np.ndarray  # (row, lane) m, one step before the last of a tick
    row_velocity: np.ndarray  # (row, lane) m/s, only if there are Laws; see row_velocity
    row_force: np.ndarray  # (row, lane) N, on the structure at the end of the last step
    row_force_before: np.ndarray  # (row, lane) N, one step earlier
    row_deflection: np.ndarray  # (row, lane) m, row compliance times row_force
    row_deflection_before: np.ndarray  # (row, lane) m
    friction_force: np.ndarray  # (law, lane) N, along the law's tangent
    slider_force: np.ndarray  # (element, lane) N
    touching: np.ndarray  # (support, lane) 1.0 while in contact
    filter_sums: np.ndarray  # (slot, mode + other channel, lane) first stage of the output filter
    counter: np.ndarray  # (2,) int64: STEPS_WITHOUT_FORCE, STEPS_DONE


class Tally(NamedTuple):
    """Sums over the steps since they were last cleared, each (.., lane)."""

    input_work: np.ndarray  # (lane,) J, of the drive and of the fluid
    fluid_work: np.ndarray  # (lane,) J, of fluid-elastic forces
    contact_work: np.ndarray  # (lane,) J, trapezoidal sum of f du over contacts and elements
    dissipated: np.ndarray  # (lane,) J, by the modal damping
    contact_steps: np.ndarray  # (support, lane)
    impacts: np.ndarray  # (support, lane)
    peak_force: np.ndarray  # (support, lane) N
    square_force: np.ndarray  # (support, lane) N² sum
    force_sum: np.ndarray  # (support, lane) N sum
    impact_velocity_square: np.ndarray  # (support, lane) (m/s)² sum over impacts
    impact_velocity_peak: np.ndarray  # (support, lane) m/s
    sliding_work: np.ndarray  # (support, lane) J: normal force times sliding distance
    land_work: np.ndarray  # (support and land, lane) J, by land; see support_lands
    force_displacement: np.ndarray  # (row, lane) N m sum of force times displacement
    row_work: np.ndarray  # (row, lane) J, trapezoidal sum of f du on contact rows
    row_force: np.ndarray  # (row, lane) N sum on contact rows
    # The next five are summed every RATIO-th step; velocities are differences over one step.
    square_displacement: np.ndarray  # (row, lane) m² sum
    displacement_sum: np.ndarray  # (row, lane) m sum
    square_velocity: np.ndarray  # (row, lane) (m/s)² sum
    product_displacement: np.ndarray  # (point, lane) m² sum of u_1 u_2
    product_velocity: np.ndarray  # (point, lane) (m/s)² sum of v_1 v_2
    element_work: np.ndarray  # (element, lane) J, trapezoidal sum of f du
    slip_work: np.ndarray  # (element, lane) J, slider force times slip
    residual: np.ndarray  # (lane,) largest relative change in the last pass of the iteration
    square_stress: np.ndarray  # (section, lane) Pa² sum
    peak_square_stress: np.ndarray  # (section, lane) Pa²


class Work(NamedTuple):
    """Work space of a step."""

    u_free: np.ndarray  # (row, lane) m, end-of-step displacement without contact forces
    u: np.ndarray  # (row, lane) m, end-of-step displacement
    force: np.ndarray  # (row, lane) N, on the structure at the end of the step
    deflection: np.ndarray  # (row, lane) m, row compliance times force
    new_force: np.ndarray  # (row, lane) N, forces of one pass
    friction_force: np.ndarray  # (law, lane) N
    slider_force: np.ndarray  # (element, lane) N
    frozen_friction_force: np.ndarray  # (law, lane) N, of the lanes that have converged
    frozen_slider_force: np.ndarray  # (element, lane) N
    resultant: np.ndarray  # (support, 2, lane) N
    channels: np.ndarray  # (displacement channel + 2 stress channels per section + 1, lane)
    bearing: np.ndarray  # (row,) int64: room for the rows that bear a force, see apply_compliance


class Output(NamedTuple):
    """The recorded output at the first decimated rate.

    An *entry* adds the modes of one group to one output channel. Entries come in whole blocks of
    CHANNEL_BLOCK; those that fill a block up add zeros to one channel behind the last.
    """

    weights: np.ndarray  # (RATIO, SLOTS) first-stage filter, by phase and slot
    channel_start: np.ndarray  # (group + 1,) first entry of each group
    stress_entry: np.ndarray  # (group,) first entry of each group that is a stress
    channel: np.ndarray  # (entry,) channel the entry adds to: displacements, then stresses
    shapes: np.ndarray  # flat, for each entry the shape over the modes of its group
    shape_start: np.ndarray  # (entry,)
    stress_start: int  # first stress channel: two per section
    stress_weight: np.ndarray  # (RATIO,) steps that a stress taken at a phase stands for; 0: none
    supports: int  # two force resultants for each, then the force channels, follow the channels
    values: np.ndarray  # (displacement or force channel, column, lane) m or N
    columns: int  # columns of values
    column: int  # the one that the first tick of this call is written to


class Hold(NamedTuple):
    """Dampers between sensors and measured motion; no sensors: the structure is free.

    Each sensor is a force channel. The drive of that channel is the measured displacement, and a
    step puts the force of the damper in its place.
    """

    channel: np.ndarray  # (sensor,) force channel
    row_start: np.ndarray  # (sensor + 1,) first of the sensor's rows in `row`
    row: np.ndarray  # (entry,) a row of each group that moves the sensor
    gain: np.ndarray  # (sensor, sensor, lane) N s/m, dampers as the implicit step takes them
    measured: np.ndarray  # (sensor, lane) m, at the end of the last step
    difference: np.ndarray  # (sensor, lane) m, measured less model, one step earlier
    memory: np.ndarray  # (sensor, lane) m/s, kept by row_velocity from the last step
    rate: np.ndarray  # (sensor, lane) m/s, work space
    strength: np.ndarray  # (sensor, lane) N s/m
    implicit: np.ndarray  # (sensor, lane) N, as the last step took it
    missed: np.ndarray  # (sensor, lane) N, what the last step should have added


class Fluid(NamedTuple):
    """Fluid-elastic forces, the force channels behind the drive's; no rows: none acts."""

    row_start: np.ndarray  # (fluid_row + 1,) first entry of each in `row`
    row: np.ndarray  # (entry,) a row of each group that moves it
    lag_start: np.ndarray  # (fluid_row + 1,) first lag of each
    stiffness: np.ndarray  # (fluid_row, lane), this and the next see fluid
    damping: np.ndarray  # (fluid_row, lane)
    lag_stiffness: np.ndarray  # (lag, lane)
    decay: np.ndarray  # (lag, lane)
    gain: np.ndarray  # (lag, lane)
    force: np.ndarray  # (fluid_row, lane) at the end of the last step, as all below
    displacement: np.ndarray  # (fluid_row, lane) one step earlier
    free: np.ndarray  # (fluid_row, lane) without forces at the end of the step
    memory: np.ndarray  # (fluid_row, lane) kept by row_velocity
    lag: np.ndarray  # (lag, lane) z, one step earlier


class Trace(NamedTuple):
    """Every step of the contact and element rows, (row, step, lane); no steps: not recorded."""

    displacement: np.ndarray  # m
    force: np.ndarray  # N, on the structure
    steps: int
