"""What Rust computes and what crosses into Python is the same, to the bit."""

import unittest

import fieldwalk
import numpy as np
from fieldwalk import ApiError, Positioner, PositionerOptions, SampleBatch
from walk import DIGEST, FOLDER, LOG, RECORDS, SAMPLES, FixBits, batch_of, hint, open_map, records, tell


def follow(positioner, batch_size):
    """As `fieldwalk replay` does: a start at the first waypoint, a fix at every step, waypoint and the end."""
    bits, batch, fixes, is_started = FixBits(), SampleBatch(), [], False

    def push():
        fixes.extend(positioner.push_samples(batch.to_bytes()))
        batch.clear()

    for record in RECORDS:
        if record.kind != "waypoint":
            record.add_to(batch)
            if len(batch) == batch_size:
                push()
            continue
        push()
        if not is_started:
            is_started = True
            positioner.hint(hint())
        fixes.append(positioner.fix_at(record.time_ns))
    push()
    positioner.flush()
    fixes.append(positioner.fix())
    for fix in fixes:
        bits.push(fix)
    return len(fixes), bits.hex()


class SameBits(unittest.TestCase):
    def test_a_walk_gives_the_bits_of_fieldwalk_replay_whatever_the_size_of_batches(self):
        with open_map() as building:
            for batch_size in (1, 7, 100, 1_000_000):
                with self.subTest(batch_size), Positioner(building, 0) as positioner:
                    n_fixes, digest = follow(positioner, batch_size)
                    self.assertGreater(n_fixes, 50)
                    tell(digest, n_fixes)
                    self.assertEqual(digest, DIGEST)

    def test_another_seed_gives_other_bits(self):
        with open_map() as building, Positioner(building, 0, PositionerOptions(seed=2)) as positioner:
            self.assertNotEqual(follow(positioner, 100)[1], DIGEST)

    def test_a_recording_replayed_gives_the_same_bits_and_arrays_of_them(self):
        with open_map() as building:
            replays = [fieldwalk.replay(building, LOG, batch_size=n) for n in (1, 7, 100, 1_000_000)]
        for replayed in replays:
            bits = FixBits()
            for fix in replayed.fixes:
                bits.push(fix)
            self.assertEqual(bits.hex(), DIGEST)
        n = len(replayed.fixes)
        self.assertEqual(replayed.position_m.shape, (n, 2))
        self.assertEqual(replayed.covariance_m2.shape, (n, 2, 2))
        self.assertEqual(replayed.position_m[-1].tolist(), [replayed.fixes[-1].position.x_m, replayed.fixes[-1].position.y_m])
        self.assertEqual(replayed.time_ns[replayed.waypoint_fix].tolist(), replayed.waypoint_time_ns.tolist())
        apart_m = np.linalg.norm(replayed.position_m[replayed.waypoint_fix] - replayed.waypoint_m, axis=1)
        np.testing.assert_allclose(apart_m[1:], replayed.waypoint_error_m[1:])
        self.assertTrue(np.isnan(replayed.waypoint_error_m[0]) and replayed.median_error_m < 3.0)
        self.assertTrue((replayed.radius_95_m > replayed.radius_68_m).all())
        self.assertIn("PARTICLE_FILTER", replayed.mode)
        self.assertEqual(replayed.status.missing, [])
        self.assertFalse(replayed.losses.was_cut)

    def test_the_encoder_gives_the_bytes_of_the_encoder_for_rust(self):
        for name in ("walk", "kinds"):
            samples = [record for record in records(name) if record.kind != "waypoint"]
            self.assertEqual(batch_of(samples), (FOLDER / f"{name}.batch").read_bytes())
        self.assertEqual(len(SampleBatch().to_bytes()), 14)

    def test_a_batch_unpacked_is_what_was_packed(self):
        arrays = fieldwalk.unpack((FOLDER / "kinds.batch").read_bytes())
        self.assertEqual(len(arrays), 9)
        self.assertEqual(arrays["pressure"]["pressure_hpa"].tolist(), [1013.25])
        self.assertEqual(arrays["specific_force"]["time_ns"].tolist(), [-(2**63)])
        self.assertEqual(arrays["ibeacon_sighting"]["minor"].tolist(), [0x8001])
        self.assertEqual(bytes(arrays["ble_sighting"]["address"][0]), bytes([0xFF, 0x80, 0x7F, 1, 2, 0]))
        recording = fieldwalk.read_recording(LOG)
        self.assertEqual(sum(len(array) for array in recording.values()), len(RECORDS))
        whole = fieldwalk.unpack((FOLDER / "walk.batch").read_bytes())
        self.assertEqual(recording["angular_rate"].tolist(), whole["angular_rate"].tolist())
        for bad in (b"", b"FWSB", (FOLDER / "walk.batch").read_bytes()[:-1]):
            self.assertRaises(ValueError, fieldwalk.unpack, bad)

    def test_a_snapshot_goes_on_to_the_same_bits(self):
        half = len(SAMPLES) // 2
        with open_map() as building, Positioner(building, 0) as whole, Positioner(building, 0) as restored:
            whole.hint(hint())
            whole.push_samples(batch_of(SAMPLES[:half]))
            restored.restore(whole.snapshot())
            second = batch_of(SAMPLES[half:])
            fixes = whole.push_samples(second)
            self.assertGreater(len(fixes), 20)
            self.assertEqual(fixes, restored.push_samples(second))

    def test_a_map_as_one_file_is_the_map_of_its_folder(self):
        with open_map() as building, fieldwalk.BuildingMap.from_file(building.export()) as again:
            self.assertEqual((again.name(), again.floors()), ("office", building.floors()))
            self.assertEqual(again.export(), building.export())
            self.assertRaises(ApiError.MapMalformed, fieldwalk.BuildingMap.from_file, building.export()[:5_000])


if __name__ == "__main__":
    unittest.main()
