# The public face: every public name, once. `microswim.X` imports its module on first use.

from . import data as data
from . import io as io
from . import plots as plots
from . import report as report
from .batch import evaluate as evaluate
from .bodies import Ellipsoid as Ellipsoid
from .bodies import NoBody as NoBody
from .bodies import Sphere as Sphere
from .bodies import Spheroid as Spheroid
from .coefficients import Constant as Constant
from .coefficients import Cox as Cox
from .coefficients import GrayHancock as GrayHancock
from .coefficients import Lighthill as Lighthill
from .coefficients import ValidityWarning as ValidityWarning
from .coefficients import closed_form as closed_form
from .customtail import CustomTail as CustomTail
from .errors import MicroswimError as MicroswimError
from .errors import SpecError as SpecError
from .gait import Gait as Gait
from .interaction import Interaction as Interaction
from .kinematics import ScrewMotion as ScrewMotion
from .metrics import summary as summary
from .design import Optimum as Optimum
from .design import design as design
from .pareto import pareto as pareto
from .robust import robustness as robustness
from .robust import sobol_indices as sobol_indices
from .robustdesign import robust_design as robust_design
from .sweep import sweep as sweep
from .swimmer import Fluid as Fluid
from .swimmer import Motion as Motion
from .swimmer import Swimmer as Swimmer
from .tails import HelicalTail as HelicalTail
from .tails import PlaneWaveTail as PlaneWaveTail
from .track import Track as Track
from .trackfit import identify_swimmer as identify_swimmer
from .trackresult import Identification as Identification
from .trajectory import screw as screw
from .trajectory import trajectory as trajectory

__version__: str
