"""Objects made, used, closed, shared between threads and left to the garbage collector."""

import gc
import os
import tempfile
import threading
import unittest
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from fieldwalk import CardDecoder, MagnetometerCalibrator, Positioner, Recorder, RecordingReader, Surveyor
from walk import SAMPLES, batch_of, hint, open_map

STATUS = Path("/proc/self/status")


def of_process(name):
    """A number of /proc/self/status."""
    line = next(line for line in STATUS.read_text().splitlines() if line.startswith(f"{name}:"))
    return int(line.split()[1])


def n_open_files():
    return len(os.listdir("/proc/self/fd"))


def held_kb(use, limit_kb, in_a_row=3, most_times=9):
    """What the process held after each use, until three in a row have added less than limit_kb together.

    A leak takes more each time; what the allocator keeps comes to an end.
    """
    held = []
    while len(held) < most_times:
        use()
        gc.collect()
        held.append(of_process("VmRSS"))
        if len(held) > in_a_row and held[-1] < held[-1 - in_a_row] + limit_kb:
            return held
    raise AssertionError(f"memory grows, kB: {held}")


class Lifetime(unittest.TestCase):
    @unittest.skipUnless(STATUS.exists(), "memory is measured through /proc")
    def test_ten_thousand_objects_leave_nothing_behind(self):
        batch = batch_of(SAMPLES[:60])
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        short = os.path.join(folder.name, "short.mcap")
        with Recorder(short) as recorder:
            recorder.push_samples(batch)
            recorder.finish()

        def cycles(n):
            for _ in range(n):
                with Positioner(building, 0) as positioner, MagnetometerCalibrator() as calibrator:
                    positioner.hint(hint())
                    positioner.push_samples(batch)
                    positioner.flush()
                    positioner.fix()
                    calibrator.push_samples(batch)
                with RecordingReader.open(short) as reader:
                    self.assertEqual(reader.next_part(1_000).n_samples, 60)
                with CardDecoder() as decoder:
                    self.assertRaises(Exception, decoder.decode_advertisement, b"")

        with open_map() as building:
            cycles(100)
            n_threads, n_files = of_process("Threads"), n_open_files()
            # Of one positioner that stayed in a hundred three times would be 15 MB.
            print("cycles by 5000, kB:", held_kb(lambda: cycles(5_000), 2_000))
            self.assertEqual((of_process("Threads"), n_open_files()), (n_threads, n_files))

    def test_use_after_close_is_an_error_and_closing_twice_is_none(self):
        building = open_map()
        positioner = Positioner(building, 0)
        building.close()
        building.close()
        self.assertRaises(ValueError, building.floors)
        self.assertRaises(ValueError, Positioner, building, 0)
        positioner.hint(hint())
        self.assertIsNotNone(positioner.fix())  # it outlives its map
        positioner.close()
        self.assertRaises(ValueError, positioner.fix)
        self.assertRaises(ValueError, positioner.push_samples, batch_of([]))

    def test_two_threads_on_one_positioner_take_turns_and_lose_nothing(self):
        # Half a minute: a thread that comes a whole minute after the other would pass for a clock that was set back.
        samples = SAMPLES[: len(SAMPLES) // 2]
        batches = [batch_of(samples[k : k + 50]) for k in range(0, len(samples), 50)]
        with open_map() as building, Positioner(building, 0) as positioner, ThreadPoolExecutor(2) as threads:
            counts = threads.map(lambda _: sum(len(positioner.push_samples(b)) for b in batches), range(2))
            self.assertGreater(sum(counts), 20)
            rejections = positioner.status().rejections
            # Of each sample one copy is taken, the other refused.
            self.assertEqual(rejections.duplicate + rejections.late, len(samples))
            self.assertEqual(rejections.implausible + rejections.jumped, 0)

    def test_an_object_closed_while_another_thread_calls_it_ends_in_an_error_at_most(self):
        batch = batch_of(SAMPLES[:200])
        with open_map() as building:
            for _ in range(50):
                positioner = Positioner(building, 0)
                began = threading.Event()

                def push():
                    while True:
                        try:
                            positioner.push_samples(batch)
                        except ValueError:
                            return
                        began.set()

                threads = [threading.Thread(target=push) for _ in range(2)]
                for thread in threads:
                    thread.start()
                began.wait()
                positioner.close()
                for thread in threads:
                    thread.join()

    def test_objects_that_nobody_closes_are_collected_without_harm(self):
        with open_map() as building:
            for _ in range(300):
                Positioner(building, 0).fix()
            gc.collect()
            self.assertRaises(Exception, Surveyor, b"", "F1", 0)
            with Positioner(building, 0) as positioner:
                self.assertEqual(positioner.status().n_recoveries, 0)


if __name__ == "__main__":
    unittest.main()
