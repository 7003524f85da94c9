"""An assembly in which parts can sit wrongly and be taken off again, after Antonelli et al.
(2021).
"""

from tandem.lab.antonelli2021.product import Product, product
from tandem.lab.antonelli2021.world import ABSENT, RIGHT, WRONG, Repair, Slips, repair

__all__ = ["ABSENT", "RIGHT", "WRONG", "Product", "Repair", "Slips", "product", "repair"]
