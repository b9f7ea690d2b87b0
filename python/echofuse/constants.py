"""Physical constants, exact."""

from typing import Final

SPEED_OF_LIGHT_MPS: Final = 299_792_458.0
