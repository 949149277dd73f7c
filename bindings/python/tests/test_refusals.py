"""What is not as it should be is a case of ApiError or a count, and changes nothing."""

import tempfile
import unittest
from pathlib import Path

import fieldwalk
from fieldwalk import (
    ApiError,
    BuildingMap,
    CardDecoder,
    MagnetometerCalibrator,
    MissingInput,
    Point2,
    PositionHint,
    Positioner,
    PositionerOptions,
    Recorder,
    RecordingDetails,
    RecordingReader,
    SampleBatch,
    Surveyor,
    SwingFault,
    Waypoint,
)
from walk import LOG, RECORDS, SAMPLES, START, batch_of, hint, open_map

PLAN = b"""{ "type": "FeatureCollection", "fieldwalk": { "frame": "metres" }, "features": [{ "type": "Feature",
  "properties": { "kind": "outline" },
  "geometry": { "type": "Polygon", "coordinates": [[[0, 0], [40, 0], [40, 25], [0, 25], [0, 0]]] } }] }"""


class Refusals(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def test_an_error_has_a_remedy_and_no_path(self):
        with self.assertRaises(ApiError.MapNotFound) as caught:
            BuildingMap.open(str(self.folder / "who-lives-here"))
        self.assertTrue(caught.exception.remedy and caught.exception.explanation)
        self.assertNotIn("who-lives-here", str(caught.exception))
        self.assertIsInstance(caught.exception, ApiError)

    def test_a_map_that_is_cut_or_changed_is_refused(self):
        with open_map() as building:
            file = building.export()
        for n_bytes in (0, 100, len(file) // 2):
            self.assertRaises(ApiError.MapMalformed, BuildingMap.from_file, file[:n_bytes])
        changed = bytearray(file)
        changed[len(file) // 2] ^= 1
        self.assertRaises(ApiError.MapCorrupt, BuildingMap.from_file, bytes(changed))

    def test_a_recording_of_another_floor_is_not_surveyed(self):
        path = str(self.folder / "upstairs.mcap")
        with Recorder(path, RecordingDetails(floor="F3")) as recorder, Surveyor(PLAN, "F1", 0) as surveyor:
            recorder.push_samples(batch_of(SAMPLES[:100]))
            recorder.finish()
            self.assertRaises(ApiError.WrongFloor, surveyor.add_recording, path, "w")

    def test_hints_floors_systems_and_times_are_checked(self):
        with open_map() as building:
            self.assertRaises(ApiError.UnknownFloor, Positioner, building, 7)
            self.assertRaises(ApiError.UnknownSystem, Positioner, building, 0, PositionerOptions(system="oracle"))
            with Positioner(building, 0) as positioner:
                self.assertIsNone(positioner.fix_at(5))
                self.assertEqual(positioner.status().missing[0].what, MissingInput.START)
                upstairs = PositionHint(point=START.point, radius_m=2.0, floor=3, time_ns=0)
                self.assertRaises(ApiError.WrongFloor, positioner.hint, upstairs)
                nowhere = PositionHint(point=Point2(x_m=float("nan"), y_m=1.0), radius_m=2.0, floor=0, time_ns=0)
                self.assertRaises(ApiError.BadHint, positioner.hint, nowhere)
                positioner.hint(hint())
                positioner.push_samples(batch_of(SAMPLES))
                self.assertRaises(ApiError.TimeInPast, positioner.fix_at, START.time_ns - 1)
                self.assertRaises(ApiError.SnapshotMalformed, positioner.restore, positioner.snapshot()[:-1])

    def test_bad_batches_are_refused_whole_by_every_object(self):
        batch = batch_of(SAMPLES[:100])
        with open_map() as building:
            surveyor = Surveyor(PLAN, "F1", 0)
            surveyor.begin_walk("w")
            recorder = Recorder(str(self.folder / "r.mcap"))
            for taker in (Positioner(building, 0), surveyor, recorder, MagnetometerCalibrator()):
                self.assertRaises(ApiError.BatchTorn, taker.push_samples, batch[:-5])
                self.assertRaises(ApiError.BatchMalformed, taker.push_samples, bytes(40))
                self.assertRaises(ApiError.BatchTooNew, taker.push_samples, batch[:4] + b"\x09" + batch[5:])
                self.assertRaises(TypeError, taker.push_samples, "text")
                taker.push_samples(batch)
            self.assertEqual(recorder.finish().n_samples, 100)

    def test_the_encoder_refuses_identities_of_a_wrong_length_and_numbers_out_of_range(self):
        batch = SampleBatch()
        self.assertRaises(ValueError, batch.ble_sighting, 0, -60.0, bytes(5))
        self.assertRaises(ValueError, batch.ibeacon_sighting, 0, -60.0, bytes(16), 65536, 0)
        self.assertRaises(OverflowError, batch.pressure, 0, 1e39)
        self.assertEqual(len(batch), 0)

    def test_recordings_are_written_once_and_read_when_torn(self):
        path = str(self.folder / "walk.mcap")
        details = RecordingDetails(device="a notebook", floor="F1")
        with Recorder(path, details) as recorder:
            self.assertRaises(ApiError.FileExists, Recorder, path)
            recorder.push_samples(batch_of(SAMPLES))
            recorder.push_waypoint(Waypoint(time_ns=START.time_ns, point=START.point))
            recorder.finish()
            self.assertRaises(ApiError.Finished, recorder.flush)
        recording = fieldwalk.read_recording(path)
        self.assertEqual(sum(len(array) for array in recording.values()), len(SAMPLES) + 1)
        torn = self.folder / "torn.mcap"
        torn.write_bytes(Path(path).read_bytes()[:-3_000])
        with RecordingReader.open(str(torn)) as reader:
            n_samples = 0
            while (part := reader.next_part(1_000)) is not None:
                n_samples += part.n_samples
            self.assertTrue(reader.losses().was_cut)
            self.assertEqual(reader.details().device, "a notebook")
        self.assertTrue(len(SAMPLES) / 2 < n_samples <= len(SAMPLES))
        self.assertRaises(ApiError.RecordingNotFound, fieldwalk.read_recording, self.folder / "none")
        (self.folder / "empty").touch()
        self.assertRaises(ApiError.RecordingMalformed, fieldwalk.read_recording, self.folder / "empty")

    def test_a_replay_needs_a_floor_of_the_map(self):
        with open_map() as building:
            self.assertRaises(ApiError.UnknownFloor, fieldwalk.replay, building, LOG, floor=3)
            replayed = fieldwalk.replay(building, LOG, floor=0, start=(START.point.x_m, START.point.y_m))
            self.assertEqual(len(replayed.waypoint_m), sum(record.kind == "waypoint" for record in RECORDS))

    def test_a_survey_of_nothing_gives_no_map_and_a_plan_can_be_drawn(self):
        self.assertRaises(ApiError.PlanMalformed, Surveyor, b"{}", "F1", 0)
        with Surveyor(PLAN, "F1", 0) as surveyor:
            drawing = surveyor.drawing()
            self.assertEqual((drawing.width_m, drawing.height_m, len(drawing.outline)), (40.0, 25.0, 1))
            self.assertRaises(ApiError.OutOfTurn, surveyor.end_walk)
            self.assertRaises(ApiError.SurveyIncomplete, surveyor.build)
            coverage = surveyor.coverage()
            self.assertEqual(len(coverage.nodes), coverage.n_columns * coverage.n_rows)
            self.assertEqual(coverage.totals.covered_m2, 0.0)

    def test_swings_and_advertisements_are_judged(self):
        with MagnetometerCalibrator() as calibrator:
            verdict = calibrator.verdict()
            self.assertTrue(verdict.is_swing_again())
            self.assertEqual(verdict.fault, SwingFault.TOO_SHORT)
        with CardDecoder() as decoder:
            self.assertRaises(ApiError.AdvertisementMalformed, decoder.decode_advertisement, bytes(30))
            self.assertRaises(ApiError.AdvertisementForeign, decoder.decode_manufacturer_data, 0x59, bytes(24))
        beacon = bytes.fromhex("0201061aff4c000215") + bytes(range(16)) + bytes([2, 1, 0, 7, 0xC5])
        self.assertEqual(fieldwalk.decode_ibeacon(beacon).major, 513)


if __name__ == "__main__":
    unittest.main()
