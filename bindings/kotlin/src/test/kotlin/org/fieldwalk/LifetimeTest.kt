package org.fieldwalk

import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertNotNull
import org.junit.jupiter.api.Assertions.assertThrows
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import java.util.concurrent.Callable
import java.util.concurrent.Executors

/** Objects on several threads, closed, and left to the garbage collector. */
class LifetimeTest {
    @Test
    fun `two threads on one positioner take turns and lose nothing`() {
        val batches = Walk.samples.chunked(50)
        val threads = Executors.newFixedThreadPool(2)
        Walk.openMap().use { map ->
            Positioner(map, 0).use { positioner ->
                // All that both push is the same: of each sample one copy is taken, the other refused.
                val tasks = List(2) {
                    Callable { batches.sumOf { positioner.pushSamples(batchOf(it).bytes()).size } }
                }
                val nFixes = threads.invokeAll(tasks).sumOf { it.get() }
                val rejections = positioner.status().rejections
                assertTrue(nFixes > 50, "$nFixes fixes")
                assertTrue(rejections.duplicate + rejections.late >= Walk.samples.size.toULong(), "$rejections")
            }
        }
        threads.shutdown()
    }

    @Test
    fun `two positioners on one map run at once and do not disturb each other`() {
        val threads = Executors.newFixedThreadPool(2)
        val start = Walk.records.first { it.kind == "waypoint" }
        Walk.openMap().use { map ->
            val task = Callable {
                Positioner(map, 0).use { positioner ->
                    positioner.hint(PositionHint(start.point, 2.0, 0, start.timeNs))
                    Walk.samples.chunked(100).flatMap { positioner.pushSamples(batchOf(it).bytes()) }
                }
            }
            val (a, b) = threads.invokeAll(listOf(task, task)).map { it.get() }
            assertTrue(a.size > 50)
            assertEquals(a, b)
        }
        threads.shutdown()
    }

    @Test
    fun `a positioner outlives its map, and use after close is an exception`() {
        val map = Walk.openMap()
        val positioner = Positioner(map, 0)
        map.close()
        map.close()
        assertThrows(IllegalStateException::class.java) { map.floors() }
        val start = Walk.records.first { it.kind == "waypoint" }
        positioner.hint(PositionHint(start.point, 2.0, 0, start.timeNs))
        assertNotNull(positioner.fix())
        positioner.close()
        assertThrows(IllegalStateException::class.java) { positioner.fix() }
        assertThrows(IllegalStateException::class.java) { positioner.pushSamples(SampleBatch().bytes()) }
    }

    @Test
    fun `ten thousand objects made, used and closed leave no thread and no memory behind`() {
        val batch = batchOf(Walk.samples.take(60))
        fun cycles(map: BuildingMap, n: Int) = repeat(n) {
            Positioner(map, 0).use { positioner ->
                positioner.hint(PositionHint(Walk.start.point, 2.0, 0, Walk.start.timeNs))
                positioner.pushSamples(batch.bytes())
                assertNotNull(positioner.fix())
            }
            MagnetometerCalibrator().use { it.pushSamples(batch.bytes()) }
            CardDecoder().close()
        }
        Walk.openMap().use { map ->
            cycles(map, 1_000)
            System.gc()
            val nThreads = Thread.getAllStackTraces().size
            val beforeKb = nativeKb()
            cycles(map, 9_000)
            System.gc()
            assertTrue(Thread.getAllStackTraces().size <= nThreads + 1, "threads")
            // A positioner that stayed in a hundred would be tens of megabytes; the JVM itself moves by some.
            if (beforeKb != null) assertTrue(nativeKb()!! - beforeKb < 40_000, "$beforeKb kB, then ${nativeKb()} kB")
        }
    }

    /** All that the process holds; of that the Java heap is fixed in size by the POM. */
    private fun nativeKb(): Long? = java.io.File("/proc/self/status").takeIf { it.exists() }?.readLines()
        ?.first { it.startsWith("VmRSS:") }?.split(Regex("\\s+"))?.get(1)?.toLong()

    @Test
    fun `a recorder, a surveyor and a decoder say so when they are closed`() {
        val decoder = CardDecoder()
        decoder.close()
        assertThrows(IllegalStateException::class.java) { decoder.decodeAdvertisement(ByteArray(31).toDirect()) }
        val calibrator = MagnetometerCalibrator()
        calibrator.close()
        assertThrows(IllegalStateException::class.java) { calibrator.verdict() }
    }

    @Test
    fun `objects that nobody closes are collected without harm`() {
        Walk.openMap().use { map ->
            repeat(300) { k ->
                Positioner(map, 0)
                if (k % 100 == 0) System.gc()
            }
            System.gc()
            Positioner(map, 0).use { assertEquals(0u, it.status().nRecoveries) }
        }
    }
}
