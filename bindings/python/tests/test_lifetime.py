"""Objects made, used, closed, shared between threads and left to the garbage collector."""

import gc
import threading
import unittest
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from fieldwalk import CardDecoder, MagnetometerCalibrator, Positioner, Surveyor
from walk import SAMPLES, batch_of, hint, open_map

STATUS = Path("/proc/self/status")


def of_process(name):
    """A number of /proc/self/status."""
    line = next(line for line in STATUS.read_text().splitlines() if line.startswith(f"{name}:"))
    return int(line.split()[1])


class Lifetime(unittest.TestCase):
    @unittest.skipUnless(STATUS.exists(), "memory is measured through /proc")
    def test_ten_thousand_objects_leave_nothing_behind(self):
        batch = batch_of(SAMPLES[:60])

        def cycles(n):
            for _ in range(n):
                with Positioner(building, 0) as positioner, MagnetometerCalibrator() as calibrator:
                    positioner.hint(hint())
                    positioner.push_samples(batch)
                    positioner.fix()
                    calibrator.push_samples(batch)
                with CardDecoder() as decoder:
                    self.assertRaises(Exception, decoder.decode_advertisement, b"")

        with open_map() as building:
            cycles(1_000)
            gc.collect()
            before_kb, n_threads = of_process("VmRSS"), of_process("Threads")
            cycles(9_000)
            gc.collect()
            grown_kb = of_process("VmRSS") - before_kb
            self.assertEqual(of_process("Threads"), n_threads)
        # One positioner that stayed in a hundred would be some megabytes.
        self.assertLess(grown_kb, 2_000, "kB more after 9,000 cycles")

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
        batches = [batch_of(SAMPLES[k : k + 50]) for k in range(0, len(SAMPLES), 50)]
        with open_map() as building, Positioner(building, 0) as positioner, ThreadPoolExecutor(2) as threads:
            counts = threads.map(lambda _: sum(len(positioner.push_samples(b)) for b in batches), range(2))
            self.assertGreater(sum(counts), 50)
            rejections = positioner.status().rejections
            # Of each sample one copy is taken, the other refused.
            self.assertGreaterEqual(rejections.duplicate + rejections.late, len(SAMPLES))

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
