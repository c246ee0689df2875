"""Shape identification of several supports: the (k, c) of each whose deflection shapes fit best.

One shape of the main peak cannot separate several supports. So the band of the shape line's spectra
is cut into blocks, each with its own operational deflection shape (ODS), the first singular vector
as in `ods`. The linear structure's shape in a block is G u, with G the sum of h h^H over the block,
h its response along the line and u the measured shape: if u is the structure's own ODS, G u is
along u. Its derivatives are closed.

A block counts by the inverse of its variance, which holds the error of the sensors' gains, the part
of the motion that is not one shape, and the error of the model's frequencies.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vibroimpact.identify.linear.supported_structure import Observed, SupportedStructure
from vibroimpact.identify.spectra.window_leakage import SpectralKernel

from .estimate import FREQUENCY_ERROR
from .ods import GAIN_ERROR
from .support_fit import (
    FoundSupports,
    LowestDamping,
    Start,
    SupportSearch,
    SupportValues,
    inverse_information,
)

BLOCK_HZ = 1.0
FEWEST_BINS = 5
# Loss factor omega c / k of the supports at the main peak that is expected, and its scatter. A
# shape hardly determines c: the expectation decides then.
LOSS, LOSS_SCATTER = 0.1, 0.3


@dataclass(frozen=True, eq=False)
class BlockShapes:
    """The deflection shapes of a record in blocks of its spectra.

    shapes: (block, line_point) complex, of unit length.
    deviation: (block,) standard deviation of a component.
    weights: (block, frequency) share of each frequency of the fine grid in a block.
    """

    shapes: np.ndarray
    deviation: np.ndarray
    weights: np.ndarray

    def of(self, blocks: np.ndarray) -> "BlockShapes":
        """Return some of the blocks: (block,) bool."""
        return BlockShapes(self.shapes[blocks], self.deviation[blocks], self.weights[blocks])


@dataclass(frozen=True)
class ShapesFit:
    """The supports whose shapes fit best.

    values: SupportValues.
    found: FoundSupports without c. The error of the model is part of their covariance.
    mac: weighted mean of the MAC over blocks.
    """

    values: SupportValues
    found: FoundSupports
    mac: float


def block_shapes(spectra: np.ndarray, frequency: np.ndarray, kernel: SpectralKernel) -> BlockShapes:
    """Return the BlockShapes of segment spectra (line_point, segment, frequency).

    frequency: (frequency,) Hz, contiguous bins.
    """
    spacing = frequency[1] - frequency[0]
    width = max(FEWEST_BINS, round(BLOCK_HZ / spacing))
    starts = range(0, frequency.size - width + 1, width)
    shapes, scatter = [], []
    for start in starts:
        part = spectra[:, :, start : start + width].reshape(len(spectra), -1).astype(complex)
        values, vectors = np.linalg.eigh(part @ part.conj().T)
        shapes.append(vectors[:, -1])
        # Motion that is not one shape turns the first vector towards the others. Impacts make it,
        # always from the same places, so that no averaging removes it.
        ratio = np.maximum(values[:-1], 0.0) / values[-1]
        turned = np.sum(ratio / np.maximum(1.0 - ratio, 1.0e-3) ** 2)
        scatter.append(turned / len(spectra))
    found = np.array(shapes)
    centre = np.array([frequency[start] + 0.5 * (width - 1) * spacing for start in starts])
    variance = (
        GAIN_ERROR**2 / found.shape[1]
        + np.array(scatter)
        + _drift(found, centre) ** 2 * FREQUENCY_ERROR**2 / found.shape[1]
    )
    weights = _block_weights(len(found), width, frequency.size, kernel)
    return BlockShapes(found, np.sqrt(variance), weights)


def _drift(shapes: np.ndarray, centre: np.ndarray) -> np.ndarray:
    """Return (block,) the length of the shapes' change per relative change of frequency."""
    moved = np.zeros(len(shapes))
    for block in range(len(shapes)):
        first, last = max(block - 1, 0), min(block + 1, len(shapes) - 1)
        if first == last:
            continue
        overlap = min(abs(np.vdot(shapes[first], shapes[last])), 1.0)
        moved[block] = np.arccos(overlap) / np.log(centre[last] / centre[first])
    return moved


def _block_weights(blocks: int, width: int, bins: int, kernel: SpectralKernel) -> np.ndarray:
    """Return (block, fine) how much each fine frequency of the band shows in each block.

    The fine grid is that of kernel.fine_index over the bins: the window smears a frequency over the
    bins around it.
    """
    fine = (bins - 1) * kernel.oversampling + 1 + 2 * kernel.half_width
    weights = np.zeros((blocks, fine))
    for block in range(blocks):
        for bin_index in range(block * width, (block + 1) * width):
            first = bin_index * kernel.oversampling
            weights[block, first : first + kernel.weights.size] += kernel.weights
    return weights


class ShapeComparison:
    """Compares the measured shapes of blocks with those of the structure on any supports."""

    def __init__(
        self,
        structure: SupportedStructure,
        observed: Observed,
        measured: BlockShapes,
        search: SupportSearch,
        force_psd: np.ndarray,
    ) -> None:
        """Prepare the comparison.

        observed: of the line's points, on the fine grid of the measured blocks.
        force_psd: (frequency,) relative PSD of the force there.
        """
        self.structure, self.observed, self.search = structure, observed, search
        share = measured.weights * force_psd
        # Without power of the force the structure's shape is 0 and has no direction.
        heard = share.sum(axis=1) > 1.0e-3 * measured.weights.sum(axis=1)
        self.measured = measured.of(heard)
        self.share = share[heard]
        self.factor = 1.0 / self.measured.deviation

    def residual(self, k: np.ndarray, c: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return (residual (residual,), jacobian (residual, 2 direction)) by ln k and c.

        The residual is the part of the measured shapes across the structure's, in standard
        deviations, and the departure of the loss factors from the expected ones.
        """
        shape, by = self._shapes(k, c)
        length = np.linalg.norm(shape, axis=1, keepdims=True)
        unit = shape / length
        measured = self.measured.shapes
        along = np.sum(unit.conj() * measured, axis=1, keepdims=True)
        across = measured - unit * along
        turn = by / length
        turn = turn - unit * np.sum(unit.conj() * turn, axis=-1, keepdims=True)
        pulled = np.sum(turn.conj() * measured, axis=-1, keepdims=True)
        slope = -(turn * along + unit * pulled)
        scale = self.factor[:, None]
        residual = _parts(across * scale)
        jacobian = np.array([_parts(column * scale) for column in slope]).T
        loss = self.search.omega * c / k
        by_k, by_c = np.diag(-loss / LOSS_SCATTER), np.diag(self.search.omega / k / LOSS_SCATTER)
        return (
            np.concatenate([residual, (loss - LOSS) / LOSS_SCATTER]),
            np.vstack([jacobian, np.hstack([by_k, by_c])]),
        )

    def _shapes(self, k: np.ndarray, c: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return (shapes G u (block, line_point), derivatives (2 direction, block, line_point))."""
        response, slope = self.structure.frf_slope(self.observed, k, c)
        laplace = 2j * np.pi * self.structure.frequency[self.observed.part, None, None]
        by = np.concatenate([slope * k[:, None, None, None], slope * laplace])
        weighted, shape = self._shape(response)
        changes = []
        for change in by:
            moved = np.einsum("fpc,bp->bfc", change.conj(), self.measured.shapes, optimize=True)
            changes.append(
                np.einsum("fpc,bfc->bp", change, weighted, optimize=True)
                + np.einsum("fpc,bfc->bp", response, moved * self.share[:, :, None], optimize=True)
            )
        return shape, np.array(changes)

    def _shape(self, response: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return (h^H u (block, frequency, channel) by its share, G u (block, line_point))."""
        seen = np.einsum("fpc,bp->bfc", response.conj(), self.measured.shapes, optimize=True)
        weighted = seen * self.share[:, :, None]
        return weighted, np.einsum("fpc,bfc->bp", response, weighted, optimize=True)

    def cost(self, k: np.ndarray, c: np.ndarray) -> float:
        """Return the squared residual of k (direction,) in N/m and c (direction,) in N s/m."""
        _, shape = self._shape(self.structure.frf(self.observed, k, c))
        along = np.abs(np.sum(shape.conj() * self.measured.shapes, axis=1)) ** 2
        across = 1.0 - along / np.sum(np.abs(shape) ** 2, axis=1)
        return float(np.sum(self.factor**2 * across))

    def fit(self, starts: Sequence[Start], lowest_c: LowestDamping) -> ShapesFit:
        """Return the ShapesFit from some starts; arguments as in SupportSearch.minimise."""
        values = self.search.best_of(self.residual, starts, lowest_c)
        count = len(values.k)
        shapes = values.residual[: len(values.residual) - count]
        points = self.measured.shapes.shape[1] - 1
        excess = max(1.0, shapes @ shapes / max(2 * points * len(self.factor) - 2 * count, 1))
        covariance = inverse_information(values.jacobian) * excess
        across = np.sum(shapes.reshape(2, len(self.factor), -1) ** 2, axis=(0, 2))
        weight = self.factor**2
        found = FoundSupports(values.k, np.full(count, np.nan), covariance)
        return ShapesFit(values, found, float(1.0 - across.sum() / weight.sum()))


def _parts(values: np.ndarray) -> np.ndarray:
    """Return the real and then the imaginary parts of complex values (block, line_point)."""
    return np.concatenate([values.real.ravel(), values.imag.ravel()])
