from rocking_cli import *
from rocking_cli import __version__ as __version__
