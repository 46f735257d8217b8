"""What the tests of the service share."""

import sys
from pathlib import Path

# Test doubles lie beside the tests; importlib mode puts no folder on the path by itself.
sys.path.insert(0, str(Path(__file__).parent))
