"""Fields of requests that name a raw part which was uploaded."""

from typing import Annotated

from annotated_types import MaxLen

from service.requests.fields import LONGEST_NAME, About
from service.requests.runs import OptionalId

StockId = Annotated[
    OptionalId,
    About("an uploaded raw part (`kind=stock`), an STL or STEP file, in place of stock"),
]
StockSolid = Annotated[
    str,
    MaxLen(LONGEST_NAME),
    About("the solid of a raw part with several, by its place in the file or its name"),
]
