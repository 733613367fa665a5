"""Feeds along the paths of NC code: read, plan within the tools' limits, and rewrite.

Only F words change, and blocks are split. Moves that are not understood, that are cut with
cutter compensation, in another frame or with a tool that the table lacks stay as they are, and
remove nothing from the stock: later moves then count as meeting more material, never less.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from optimiser.along_path.caps import CutBounds
from optimiser.along_path.tool_bounds import bounds_of_tool
from optimiser.modes import Mode
from service.along_path.course import BlockLog, Part
from service.along_path.run import AlongPath, along_path
from service.along_path.task import task_of
from service.chosen import load_material_named, require_axes
from service.files import read_bytes
from service.raw_stock import GivenStock, raw_stock_of, stock_map
from service.reading import Tell, silent
from service.requests.advice import AdviceRequest
from service.simulation.setup import PreparedRun
from simulator.library import load_machine
from simulator.machine.interpreter import Numbered
from simulator.machine.tooling import table_tool
from simulator.spec import Machine, MaterialMatch
from simulator.tool_files.read import read_tools
from simulator.tool_table import TableTool
from stepnc_model.errors import Finding, Severity, StepNcError
from stepnc_model.nc.advice import BlockAdvice, RewrittenCode
from stepnc_model.nc.moves import MoveFlag, NcMoves
from stepnc_model.nc.neutral_blocks import neutral_blocks
from stepnc_model.nc.program import NcProgram, read_program
from stepnc_model.nc.rewrite import rewrite
from stepnc_model.post.blocks import Block, Circular, Comment, Linear, ToolChange
from stepnc_model.post.dialect import Dialect
from stepnc_model.units import mm_from_um, speed_from_mm_min
