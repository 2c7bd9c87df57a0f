"""Films of soft bodies: scenes in time, bodies made of arrays, pictures. The manual's page is docs/python.md."""

from typing import NamedTuple


class Problem(NamedTuple):
    """One thing that is wrong with an input. line and column count from 1; 0: the input as a whole."""

    file: str
    line: int
    column: int
    message: str


class InputError(ValueError):
    """Input that cannot be used. `problems` lists all that is wrong, as Problem."""

    problems: list = []


class RunError(RuntimeError):
    """Work that cannot go on: a full disk, a lost renderer, a matrix that cannot be factored."""


class StepFailed(RuntimeError):
    """A step that failed. The message names frame, body and reason."""


class SuppleWarning(UserWarning):
    """What is legal but unwise in a scene, and steps that did not come near their solution."""


from . import _supple  # noqa: E402  (it raises what is defined above)
from ._supple import Body, Colliders, Model, State, WorldState, replays, scenes, step  # noqa: E402


class Film(_supple.Film):
    """A film that ffmpeg encodes while its pictures are added. path: ends in .mp4, .webm, .mov or .gif."""

    def __enter__(self):
        return self

    def __exit__(self, kind, error, trace):
        self.close()


class Picture(bytes):
    """The bytes of a PNG, which notebooks show."""

    def _repr_png_(self):
        return bytes(self)


class Grab:
    """Vertices that World.grab() holds by springs."""

    def __init__(self, world, body, name):
        self._world, self.body, self.name = world, body, name

    def move(self, move, turn_deg=(0, 0, 0)):
        """Moves the vertices' targets over the next frame. move: from where they were grabbed [m]. turn_deg: about
        the middle of what was grabbed, about x, then y, then z."""
        self._world._move(self.body, self.name, move, turn_deg)

    def release(self):
        """Lets the vertices go before the next frame."""
        self._world._release(self.body, self.name)


class World(_supple.World):
    __doc__ = _supple.World.__doc__

    def grab(self, body, vertices, *, stiffness, name=""):
        """Holds vertices where they are from the next frame on, and returns a Grab that moves and releases them.

        body: a name. vertices: numbers, counted from 0, or a mask. stiffness: of the spring of each vertex [N/m]; a tenth of the
        body's weight, over the number of vertices and a hundredth of the body's size, is a useful scale."""
        return Grab(self, body, self._grab(body, vertices, stiffness, name))

    def show(self, *, camera=None, size=None, set={}):
        """Returns a Picture of the world, which a notebook shows. The arguments are those of render()."""
        return Picture(self._png(camera, size, set))


def render(world, *, camera=None, size=None, set={}):
    """Draws the world as it is: height x width x 3 bytes, or x 4 with coverage for look.backdrop = "transparent".

    camera: a dict with the keys of [camera], in place of the scene's whole table. size: (width, height) in pixels. set: other values of the scene, such as
    {"field.quantity": "stretch"}. Pictures that differ by the camera alone share the preparations."""
    return world._pixels(camera, size, set)


__all__ = [
    "Body", "Colliders", "Film", "Grab", "InputError", "Model", "Picture", "Problem", "RunError", "State",
    "StepFailed", "SuppleWarning", "World", "WorldState", "render", "replays", "scenes", "step",
]
