"""The folder that tests/examples/walk_for_bindings.rs has written; it says what is in it."""

import hashlib
import os
import struct
from pathlib import Path

import fieldwalk
from fieldwalk import Attitude, CarryMode, FixMode, Point2, PositionHint, SampleBatch

FOLDER = Path(os.environ["FIELDWALK_WALK"])  # run by: cargo xtask python
MAP = str(FOLDER / "map")
LOG = str(FOLDER / "walk.txt")
#: What `fieldwalk replay --bits` says of the walk.
DIGEST = (FOLDER / "walk.bits").read_text().split()[0]


def tell(digest, n_fixes):
    """Leaves the digest of the walk's fixes as Python found it, for the report of `cargo xtask test`."""
    (FOLDER / "python.bits").write_text(f"{digest} {n_fixes}\n")


class Record:
    """A line of a `.samples` file."""

    def __init__(self, line):
        time_ns, self.kind, *self.fields = line.split()
        self.time_ns = int(time_ns)

    @property
    def point(self):
        x_m, y_m = (struct.unpack(">d", bytes.fromhex(field))[0] for field in self.fields)
        return Point2(x_m=x_m, y_m=y_m)

    def add_to(self, batch):
        def value(k, field):
            if self.kind == "card_frame" or (self.kind.endswith("_sighting") and k > 0):
                return bytes.fromhex(field) if len(field) > 5 else int(field)
            return struct.unpack(">f", bytes.fromhex(field))[0]

        getattr(batch, self.kind)(self.time_ns, *(value(k, field) for k, field in enumerate(self.fields)))


def records(name="walk"):
    return [Record(line) for line in (FOLDER / f"{name}.samples").read_text().splitlines()]


RECORDS = records()
SAMPLES = [record for record in RECORDS if record.kind != "waypoint"]
START = next(record for record in RECORDS if record.kind == "waypoint")


def hint():
    return PositionHint(point=START.point, radius_m=2.0, floor=0, time_ns=START.time_ns)


def batch_of(some):
    batch = SampleBatch()
    for record in some:
        record.add_to(batch)
    return batch.to_bytes()


def open_map():
    return fieldwalk.BuildingMap.open(MAP)


class FixBits:
    """The digest that `fieldwalk replay --bits` prints, of fixes as Python sees them; defined in cli/src/bits.rs."""

    MODES = {
        FixMode.STARTED: 0,
        FixMode.PARTICLE_FILTER: 1,
        FixMode.STALE: 2,
        FixMode.BEACON: 3,
        FixMode.PAUSED: 4,
        FixMode.OTHER: 255,
    }

    ATTITUDES = {
        Attitude.UNKNOWN: 0,
        Attitude.UPWARD_FORWARD_HORIZONTAL: 1,
        Attitude.UPWARD_FORWARD_INCLINED: 2,
        Attitude.UPWARD_NOT_FORWARD: 3,
        Attitude.NOT_UPWARD: 4,
    }
    CARRY_MODES = {
        CarryMode.UNKNOWN: 0,
        CarryMode.HELD_UP: 1,
        CarryMode.HELD_UPRIGHT: 2,
        CarryMode.CALLING: 3,
        CarryMode.SWINGING: 4,
        CarryMode.FRONT_POCKET: 5,
        CarryMode.BACK_POCKET: 6,
        CarryMode.ON_TABLE: 7,
    }

    def __init__(self):
        self._digest = hashlib.sha256()

    def push(self, fix):
        place = fix.latitude_longitude
        nan = float("nan")
        numbers = (
            fix.position.x_m, fix.position.y_m, fix.heading_rad, fix.speed_m_s,
            fix.covariance_xx_m2, fix.covariance_xy_m2, fix.covariance_xy_m2, fix.covariance_yy_m2,
            fix.radius_68_m, fix.radius_95_m,
            place.latitude_deg if place else nan, place.longitude_deg if place else nan,
        )  # fmt: skip
        # One NaN for all.
        numbers = [nan if number != number else number for number in numbers]
        cases = (self.MODES[fix.mode], self.ATTITUDES[fix.attitude], self.CARRY_MODES[fix.carry_mode])
        self._digest.update(struct.pack("<qi12d3B", fix.time_ns, fix.floor, *numbers, *cases))

    def hex(self):
        return self._digest.hexdigest()
