"""What a laser scanner reports for a surface at a range and an incidence angle.

The received power follows the laser range equation (Wagner et al., ISPRS Journal 60(2), 2006;
Höfle and Pfeifer, ISPRS Journal 62(6), 2007, the thesis's eq. 6.19), with two departures that real
scanners show: biaxial optics lose power in the near range, and the reported value is no linear
function of the power (figure 6.11).

Where the numbers come from:

- reflectances are round values within what the ECOSTRESS spectral library (Meerdink et al., Remote
  Sensing of Environment 230, 2019) shows near 0.9 micrometres for green grass, road asphalt and
  paving; that of light tiles lies between asphalt and lawn, as in figure 6.6;
- range noise: SICK's and Hokuyo's data sheets name 10, 12 and 30 mm as upper values of the
  statistical error for LMS 291, LMS 151 and UTM-30LX; Pomerleau et al. ("Noise characterization of
  depth sensors for surface inspections", CARPI 2012) measured 12 mm (LMS 151) and 18 mm (UTM-30LX);
- the angle exponents, the spread from beam to beam, the near-range constants and the response
  curves are chosen, not measured: so that all scanners report more for grass than for asphalt, the
  LMS 291 separates best, the LMS 151 is difficult below about 1 m and the UTM-30LX overlaps there
  (section 6.6), and range differences alone classify about 75 % (section 6.9.1).
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray


class Material(IntEnum):
    """What a beam can hit."""

    ASPHALT = 0
    LIGHT_TILES = 1
    LAWN = 2
    GRAVEL = 3
    """Loose gravel overgrown by grass."""
    FOLIAGE = 4
    """Hedges and crowns."""
    BARK = 5
    PLASTER = 6


@dataclass(frozen=True, slots=True)
class Surface:
    """How a material reflects."""

    reflectance: float
    """At about 905 nm."""
    angle_exponent: float
    """Received power falls with this power of cos(incidence): 1 is Lambert's law."""
    spread: float
    """Relative standard deviation from beam to beam: grain, blades, shadows."""
    relief_m: float
    """Standard deviation of the height that a beam ends at."""


SURFACES: dict[Material, Surface] = {
    Material.ASPHALT: Surface(0.14, 0.7, 0.08, 0.001),
    Material.LIGHT_TILES: Surface(0.24, 1.0, 0.06, 0.001),
    Material.LAWN: Surface(0.50, 0.4, 0.12, 0.007),
    Material.GRAVEL: Surface(0.22, 0.6, 0.15, 0.008),
    Material.FOLIAGE: Surface(0.50, 0.3, 0.20, 0.03),
    Material.BARK: Surface(0.30, 0.8, 0.12, 0.005),
    Material.PLASTER: Surface(0.40, 1.0, 0.05, 0.001),
}
GRASS_IN_GRAVEL = 0.5
"""Share of beams that end on grass where gravel is overgrown."""
VEGETATION = frozenset({Material.LAWN, Material.FOLIAGE})
PAVED = frozenset({Material.ASPHALT, Material.LIGHT_TILES})


@dataclass(frozen=True, slots=True)
class Scanner:
    """A laser range finder: geometry, noise, and how it reports received power."""

    name: str
    field_of_view_rad: float
    beam_step_rad: float
    range_noise_m: float
    overlap_m: float
    """Range scale of the near-range loss: a share exp(-(R / overlap)^2) of the power is lost."""
    near_noise: float
    """Relative noise of the power at range zero, fading over `overlap_m`."""
    noise: float
    """Relative noise of the power everywhere."""
    knee: float
    """Power around which the response turns from linear to logarithmic."""
    full_scale: float
    """Reported value for a white surface at 1 m."""
    offset_noise: float
    """Standard deviation of the reported value, in its unit."""


LMS_291 = Scanner("LMS 291-S05", np.pi, np.pi / 180, 0.010, 0.35, 0.0, 0.04, 0.02, 255.0, 1.5)
LMS_151 = Scanner("LMS 151", 1.5 * np.pi, np.pi / 360, 0.012, 0.60, 0.30, 0.05, 0.05, 255.0, 2.0)
UTM_30LX = Scanner(
    "UTM-30LX", 1.5 * np.pi, np.pi / 720, 0.018, 0.80, 0.35, 0.05, 0.01, 4095.0, 40.0
)
SCANNERS = {scanner.name: scanner for scanner in (LMS_291, LMS_151, UTM_30LX)}


def reflectances(seed: int, spread: float = 0.06) -> NDArray[np.float64]:
    """Reflectance of each material `(materials,)` as one place has it: age, dirt, season."""
    random = np.random.default_rng([seed, 905])
    mean = np.array([SURFACES[material].reflectance for material in Material])
    return np.asarray(mean * np.exp(random.normal(0.0, spread, len(mean))))


def remission(  # noqa: PLR0917
    scanner: Scanner,
    material: NDArray[np.uint8],
    range_m: NDArray[np.float64],
    incidence_rad: NDArray[np.float64],
    reflectance: NDArray[np.float64],
    random: np.random.Generator,
) -> NDArray[np.float64]:
    """Reported remission `(n,)` of beams that end on `material` `(n,)`.

    `reflectance` `(materials,)` is the place's; the unit of the result is the scanner's.
    """
    surfaces = [SURFACES[kind] for kind in Material]
    exponent = np.array([surface.angle_exponent for surface in surfaces])[material]
    spread = np.array([surface.spread for surface in surfaces])[material]
    cosine = np.clip(np.cos(incidence_rad), 0.02, 1.0)
    nearness = np.exp(-((range_m / scanner.overlap_m) ** 2))
    power = reflectance[material] * cosine**exponent / range_m**2 * (1.0 - nearness)
    relative = np.hypot(np.hypot(spread, scanner.noise), scanner.near_noise * nearness)
    power *= np.exp(random.normal(0.0, 1.0, len(power)) * relative)
    reported = scanner.full_scale * np.log1p(power / scanner.knee) / np.log1p(1.0 / scanner.knee)
    reported += random.normal(0.0, scanner.offset_noise, len(power))
    return np.asarray(np.rint(np.clip(reported, 0.0, None)))
