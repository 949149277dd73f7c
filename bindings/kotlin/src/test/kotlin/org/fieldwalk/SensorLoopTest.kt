package org.fieldwalk

import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertNull
import org.junit.jupiter.api.Assertions.assertThrows
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import java.lang.reflect.InvocationTargetException
import java.nio.ByteBuffer
import java.util.concurrent.Callable
import java.util.concurrent.Executors

/** The way over JNI does what the usual one does. */
class SensorLoopTest {
    private fun usual(): List<Fix> = Walk.openMap().use { map ->
        Positioner(map, 0).use {
            it.hint(Walk.hint)
            it.pushSamples(batchOf(Walk.samples).bytes())
        }
    }

    private fun <R> placed(body: (Positioner, SensorLoop) -> R): R = Walk.openMap().use { map ->
        Positioner(map, 0).use { positioner ->
            positioner.hint(Walk.hint)
            SensorLoop(positioner).use { body(positioner, it) }
        }
    }

    @Test
    fun `the fixes are those of the usual way, whatever the size of batches`() {
        assertTrue(SensorLoop.isSupported)
        val expected = usual()
        assertTrue(expected.size > 50)
        for (size in listOf(1, 40, 1_000_000)) {
            val batch = SampleBatch(capacityBytes = 64)
            val fixes = placed { _, loop ->
                Walk.samples.chunked(size).flatMap { records ->
                    batch.clear()
                    records.forEach { it.addTo(batch) }
                    loop.push(batch)
                }
            }
            assertEquals(expected, fixes)
        }
    }

    @Test
    fun `both ways lead into one positioner, which the loop outlives`() {
        val halves = Walk.samples.chunked(Walk.samples.size / 2 + 1)
        val fixes = placed { positioner, loop ->
            val first = positioner.pushSamples(batchOf(halves[0]).bytes())
            positioner.close()
            first + loop.push(batchOf(halves[1]))
        }
        assertEquals(usual(), fixes)
    }

    @Test
    fun `a loop that is closed refuses, and leaves the positioner open`() = placed { positioner, loop ->
        loop.close()
        loop.close()
        assertThrows(IllegalStateException::class.java) { loop.push(SampleBatch()) }
        assertEquals(0uL, positioner.status().batchFaults.malformed)
        positioner.pushSamples(SampleBatch().bytes())
        Unit
    }

    @Test
    fun `an empty batch gives nothing, two threads take turns`() = placed { positioner, loop ->
        assertEquals(emptyList<Fix>(), loop.push(SampleBatch()))
        val samples = Walk.samples.take(Walk.samples.size / 2)
        val threads = Executors.newFixedThreadPool(2)
        val push = Callable { samples.chunked(50).sumOf { loop.push(batchOf(it)).size } }
        val nFixes = threads.invokeAll(listOf(push, push)).sumOf { it.get() }
        threads.shutdown()
        val rejections = positioner.status().rejections
        assertTrue(nFixes > 20)
        assertEquals(samples.size.toULong(), rejections.duplicate + rejections.late, "$rejections")
    }

    @Test
    fun `ten thousand loops made, used and closed leave no thread or memory behind`() = Walk.openMap().use { map ->
        val batch = batchOf(Walk.samples.take(60))
        fun cycles(n: Int) = repeat(n) {
            Positioner(map, 0).use { positioner -> SensorLoop(positioner).use { it.push(batch) } }
        }
        cycles(5_000)
        val before = ProcessUse.now()
        println("loops by 5000, kB: ${FlatMemory.after(8_000) { cycles(5_000) }}")
        val after = ProcessUse.now()
        assertTrue(after.nThreads <= before.nThreads + 1 && after.nFiles <= before.nFiles, "$before, then $after")
    }

    /** The encoder makes no such batches and lengths, so the native function itself is asked. */
    @Test
    fun `what is no batch is refused, and a length that is none is an exception`() = placed { positioner, loop ->
        val native = SensorLoop::class.java
            .getDeclaredMethod("pushOverJni", Long::class.java, ByteBuffer::class.java, Int::class.java)
        native.isAccessible = true
        val handle = SensorLoop::class.java.getDeclaredField("handle").also { it.isAccessible = true }.getLong(loop)
        fun push(buffer: ByteBuffer?, nBytes: Int) = native.invoke(loop, handle, buffer, nBytes) as ByteArray?
        val batch = batchOf(Walk.samples.take(100)).bytes().toByteArray()
        assertEquals(0, push(batch.toDirect(), batch.size - 3)!!.size)
        assertEquals(0, push(ByteArray(40).toDirect(), 40)!!.size)
        assertEquals(0, push(ByteBuffer.allocateDirect(0), 0)!!.size)
        assertNull(push(batch.toDirect(), batch.size))
        for ((buffer, nBytes) in listOf(batch.toDirect() to batch.size + 1, batch.toDirect() to -1, null to 4, ByteBuffer.wrap(batch) to 4)) {
            val thrown = assertThrows(InvocationTargetException::class.java) { push(buffer, nBytes) }
            assertTrue(thrown.targetException is RuntimeException, "${thrown.targetException}")
        }
        assertEquals(BatchFaults(0u, 0u), positioner.status().batchFaults)
    }
}
