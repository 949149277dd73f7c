"""Recordings replayed on a map."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Optional, Union

import numpy as np

from .fieldwalk_ffi import (
    ApiError,
    BuildingMap,
    Fix,
    Point2,
    PositionHint,
    Positioner,
    PositionerOptions,
    RecordingLosses,
    RecordingReader,
    Status,
)


@dataclass(frozen=True)
class Replayed:
    """What a replay gave: an entry a fix, at every step, every waypoint and the end; then one a waypoint.

    Fixes stand in the order in which they became known. A step is known a moment after it was made, so the time of a fix
    may lie before that of a waypoint's fix just ahead of it.
    """

    #: The fixes themselves.
    fixes: list[Fix]
    #: Time on the clock of the samples, in nanoseconds.
    time_ns: np.ndarray
    #: Position in the floor's frame, in metres: columns x and y.
    position_m: np.ndarray
    #: Latitude and longitude in degrees; NaN where the map is not georeferenced.
    latitude_longitude_deg: np.ndarray
    #: Walking direction, clockwise from the plan's y, in radians from -π to π.
    heading_rad: np.ndarray
    #: Walking speed, in m/s.
    speed_m_s: np.ndarray
    #: Covariance of the position, in m²: a matrix of 2 by 2 a fix.
    covariance_m2: np.ndarray
    #: Radius that holds the truth 68 times of a hundred, in metres.
    radius_68_m: np.ndarray
    #: Radius that holds the truth 95 times of a hundred, in metres.
    radius_95_m: np.ndarray
    #: What the fix rests on: the name of a ``FixMode``, such as ``PARTICLE_FILTER``.
    mode: np.ndarray
    #: When the walker stood at each waypoint, in nanoseconds.
    waypoint_time_ns: np.ndarray
    #: Where, in metres: columns x and y.
    waypoint_m: np.ndarray
    #: Which fix is the waypoint's, an index; -1 where there was none.
    waypoint_fix: np.ndarray
    #: How far off the fix was there, in metres; NaN at the start and where there was none.
    waypoint_error_m: np.ndarray
    #: What the positioner left out.
    status: Status
    #: What the recording did not give.
    losses: RecordingLosses

    @property
    def median_error_m(self) -> float:
        """Median error at waypoints but the first, in metres; NaN without any."""
        known = self.waypoint_error_m[~np.isnan(self.waypoint_error_m)]
        return float(np.median(known)) if known.size else float("nan")


def replay(
    building: BuildingMap,
    recording: Union[str, os.PathLike],
    *,
    floor: Optional[int] = None,
    system: str = "fused",
    seed: int = 1,
    start: Optional[tuple[float, float]] = None,
    start_radius_m: float = 2.0,
    batch_size: int = 1000,
) -> Replayed:
    """Replays the recording at a path, of any format that Fieldwalk reads, as ``fieldwalk replay`` does: to the same
    bits, whatever ``batch_size``.

    :param floor: The floor's ordinal; by default the one that the recording names, or else the building's only one.
    :param start: A place, x and y in metres, where the walk begins; by default its first waypoint.
    :param start_radius_m: How far off the start may be along each axis, in metres.
    :raises ApiError: when the recording cannot be read, the building has no such floor, or there is no such system.
    :raises ValueError: when it must be said which floor is meant, or the recording is of another one.
    """
    path = os.fspath(recording)
    floor = _floor_of(building, path, floor)
    fixes: list[Fix] = []
    waypoints: list[tuple[int, float, float, int, float]] = []
    options = PositionerOptions(system=system, seed=seed)
    with Positioner(building, floor, options) as positioner, RecordingReader.open_on(path, building, floor) as reader:
        is_started = start is None

        def hint(point: Point2, time_ns: int) -> None:
            positioner.hint(PositionHint(point=point, radius_m=start_radius_m, floor=floor, time_ns=time_ns))

        while (part := reader.next_part(batch_size)) is not None:
            if not is_started:
                # Known before the first sample is taken in.
                hint(Point2(x_m=start[0], y_m=start[1]), _first_time_ns(part))
                is_started = True
            fixes += positioner.push_samples(part.samples)
            if part.waypoint is None:
                continue
            time_ns, point = part.waypoint.time_ns, part.waypoint.point
            is_first = not waypoints
            if is_first and start is None:
                hint(point, time_ns)
            try:
                fix = positioner.fix_at(time_ns)
            except ApiError.TimeInPast:
                fix = None
            index, error_m = -1, float("nan")
            if fix is not None:
                index = len(fixes)
                fixes.append(fix)
                if not is_first:
                    error_m = float(np.hypot(fix.position.x_m - point.x_m, fix.position.y_m - point.y_m))
            waypoints.append((time_ns, point.x_m, point.y_m, index, error_m))
        positioner.flush()
        last = positioner.fix()
        if last is not None:
            fixes.append(last)
        return _replayed(fixes, waypoints, positioner.status(), reader.losses())


def _floor_of(building: BuildingMap, path: str, floor: Optional[int]) -> int:
    """The floor that is meant."""
    with RecordingReader.open(path) as reader:
        # A log in degrees fails at its waypoints here, and says its floor all the same.
        try:
            reader.next_part(1)
        except ApiError:
            pass
        named = reader.floor()
    ordinals = [info.ordinal for info in building.floors()]
    if floor is None:
        if named is not None:
            return named
        if len(ordinals) == 1:
            return ordinals[0]
        raise ValueError(f"the recording names no floor: give one of {ordinals}")
    if named is not None and named != floor:
        raise ValueError(f"the recording says that it was made on floor {named}")
    return floor


def _first_time_ns(part) -> int:
    """The time of the first record of a part: eight bytes, after the batch's header, a code and a length."""
    if part.n_samples:
        return int.from_bytes(part.samples[16:24], "little", signed=True)
    return part.waypoint.time_ns


def _replayed(fixes, waypoints, status, losses) -> Replayed:
    def column(value, dtype=float):
        return np.array([value(fix) for fix in fixes], dtype=dtype)

    def place_deg(fix):
        place = fix.latitude_longitude
        return (np.nan, np.nan) if place is None else (place.latitude_deg, place.longitude_deg)

    def covariance_m2(fix):
        xy = fix.covariance_xy_m2
        return ((fix.covariance_xx_m2, xy), (xy, fix.covariance_yy_m2))

    columns = [("time_ns", "i8"), ("x_m", "f8"), ("y_m", "f8"), ("fix", "i8"), ("error_m", "f8")]
    at = np.array(waypoints, dtype=columns)
    return Replayed(
        fixes=fixes,
        time_ns=column(lambda fix: fix.time_ns, np.int64),
        position_m=column(lambda fix: (fix.position.x_m, fix.position.y_m)).reshape(-1, 2),
        latitude_longitude_deg=column(place_deg).reshape(-1, 2),
        heading_rad=column(lambda fix: fix.heading_rad),
        speed_m_s=column(lambda fix: fix.speed_m_s),
        covariance_m2=column(covariance_m2).reshape(-1, 2, 2),
        radius_68_m=column(lambda fix: fix.radius_68_m),
        radius_95_m=column(lambda fix: fix.radius_95_m),
        mode=column(lambda fix: fix.mode.name, str),
        waypoint_time_ns=at["time_ns"],
        waypoint_m=np.column_stack([at["x_m"], at["y_m"]]),
        waypoint_fix=at["fix"],
        waypoint_error_m=at["error_m"],
        status=status,
        losses=losses,
    )
