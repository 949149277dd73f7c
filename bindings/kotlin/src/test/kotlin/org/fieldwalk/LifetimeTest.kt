package org.fieldwalk

import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertNotNull
import org.junit.jupiter.api.Assertions.assertThrows
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.junit.jupiter.api.io.TempDir
import java.io.File
import java.util.concurrent.CountDownLatch
import java.util.concurrent.Callable
import java.util.concurrent.Executors

/** Objects on several threads, closed, and left to the garbage collector. */
class LifetimeTest {
    @Test
    fun `two threads on one positioner take turns and lose nothing`() {
        // Half a minute: a thread that comes a whole minute after the other would pass for a clock that was set back.
        val samples = Walk.samples.take(Walk.samples.size / 2)
        val batches = samples.chunked(50)
        val threads = Executors.newFixedThreadPool(2)
        Walk.openMap().use { map ->
            Positioner(map, 0).use { positioner ->
                // All that both push is the same: of each sample one copy is taken, the other refused.
                val tasks = List(2) {
                    Callable { batches.sumOf { positioner.pushSamples(batchOf(it).bytes()).size } }
                }
                val nFixes = threads.invokeAll(tasks).sumOf { it.get() }
                val rejections = positioner.status().rejections
                assertTrue(nFixes > 20, "$nFixes fixes")
                assertEquals(samples.size.toULong(), rejections.duplicate + rejections.late, "$rejections")
                assertEquals(0uL, rejections.implausible + rejections.jumped, "$rejections")
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
    fun `an object closed while other threads call it ends in an exception at most`() {
        val batch = batchOf(Walk.samples.take(200)).bytes()
        val threads = Executors.newFixedThreadPool(2)
        Walk.openMap().use { map ->
            repeat(50) {
                val positioner = Positioner(map, 0)
                val began = CountDownLatch(1)
                val push = Callable {
                    assertThrows(IllegalStateException::class.java) {
                        while (true) {
                            positioner.pushSamples(batch.duplicate())
                            began.countDown()
                        }
                    }
                }
                val pushing = List(2) { threads.submit(push) }
                began.await()
                positioner.close()
                pushing.forEach { it.get() }
            }
        }
        threads.shutdown()
    }

    @Test
    fun `ten thousand objects made, started, stopped and closed leave no thread, file or memory behind`(@TempDir folder: File) {
        val batch = batchOf(Walk.samples.take(60)).bytes()
        val file = File(folder, "short.mcap").path
        Recorder(file).use {
            it.pushSamples(batch.duplicate())
            it.finish()
        }
        fun cycles(map: BuildingMap, n: Int) = repeat(n) {
            Positioner(map, 0).use { positioner ->
                positioner.hint(Walk.hint)
                positioner.pushSamples(batch.duplicate())
                positioner.flush()
                assertNotNull(positioner.fix())
            }
            MagnetometerCalibrator().use { it.pushSamples(batch.duplicate()) }
            RecordingReader.open(file).use { assertEquals(60u, it.nextPart(1_000u)?.nSamples) }
            CardDecoder().close()
        }
        Walk.openMap().use { map ->
            cycles(map, 5_000) // the JVM has compiled and loaded most of what it will
            val before = ProcessUse.now()
            // A positioner with its particles takes about 100 kB: of one kept of a hundred three times would be 15 MB.
            println("cycles by 5000, kB: ${FlatMemory.after(8_000) { cycles(map, 5_000) }}")
            val after = ProcessUse.now()
            val grown = "$before, then $after"
            // A thread of the JVM's own may come or go.
            assertTrue(after.nThreads <= before.nThreads + 1, grown)
            assertTrue(after.nFiles <= before.nFiles, grown)
        }
    }

    @Test
    fun `thousands of recordings and surveys leave no file open`(@TempDir folder: File) {
        val batch = batchOf(Walk.samples.take(60)).bytes()
        val before = ProcessUse.now()
        repeat(1_000) { k ->
            // Every other one is closed without its end, as by an app that was left.
            Recorder(File(folder, "$k.mcap").path).use {
                it.pushSamples(batch.duplicate())
                if (k % 100 == 0) it.finish()
            }
            Surveyor(Walk.plan.toDirect(), "F1", 0).use {
                it.beginWalk("w")
                it.pushSamples(batch.duplicate())
                it.endWalk()
            }
        }
        val after = ProcessUse.now()
        assertTrue(after.nFiles <= before.nFiles && after.nThreads <= before.nThreads + 1, "$before, then $after")
    }

    @Test
    fun `every object says so when it is closed`(@TempDir folder: File) {
        fun refused(call: () -> Unit) = assertThrows(IllegalStateException::class.java) { call() }
        val file = File(folder, "walk.mcap").path
        Recorder(file).also { it.close() }.let { refused { it.flush() } }
        RecordingReader.open(Walk.log.path).also { it.close() }.let { refused { it.nextPart(1u) } }
        Surveyor(Walk.plan.toDirect(), "F1", 0).also { it.close() }.let { refused { it.beginWalk("w") } }
        CardDecoder().also { it.close() }.let { refused { it.decodeAdvertisement(ByteArray(31).toDirect()) } }
        MagnetometerCalibrator().also { it.close() }.let { refused { it.verdict() } }
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
