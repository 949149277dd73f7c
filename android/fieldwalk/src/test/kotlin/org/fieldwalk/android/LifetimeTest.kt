package org.fieldwalk.android

import kotlinx.coroutines.CoroutineScope
import kotlinx.coroutines.Dispatchers
import kotlinx.coroutines.cancel
import kotlinx.coroutines.flow.toList
import kotlinx.coroutines.launch
import kotlinx.coroutines.runBlocking
import org.fieldwalk.FixMode
import org.fieldwalk.FlatMemory
import org.fieldwalk.PositionHint
import org.fieldwalk.Positioner
import org.fieldwalk.Record
import org.fieldwalk.SampleBatch
import org.fieldwalk.Walk
import org.junit.Assert.assertEquals
import org.junit.Assert.assertFalse
import org.junit.Assert.assertNotNull
import org.junit.Assert.assertThrows
import org.junit.Assert.assertTrue
import org.junit.Test
import org.junit.runner.RunWith
import org.robolectric.RobolectricTestRunner

/** Starts and stops in any order and number, long runs, gaps: nothing is left behind. */
@RunWith(RobolectricTestRunner::class)
class LifetimeTest {
    private val phone = SimulatedPhone().also { it.grantAll() }

    private fun session(sensing: Sensing = Sensing()) =
        Walk.openMap().use { Fieldwalk.positioner(phone.context, it, sensing = sensing) }

    @Test
    fun `sensors run while somebody reads, or from start to stop`() {
        val session = session()
        fun isRunning() = session.status.value.isRunning
        val readers = List(2) { CoroutineScope(Dispatchers.Unconfined) }
        readers.forEach { reader -> reader.launch { session.fixes().collect { } } }
        assertTrue(isRunning())
        readers[0].cancel()
        assertTrue(isRunning())
        readers[1].cancel()
        assertFalse(isRunning())
        repeat(2) { session.start() }
        assertTrue(isRunning())
        assertEquals(1, phone.nScans)
        var hasEnded = false
        CoroutineScope(Dispatchers.Unconfined).launch {
            session.fixes().collect { }
            hasEnded = true
        }
        repeat(2) { session.stop() }
        assertTrue(hasEnded && !isRunning())
        assertEquals(0, phone.nScans)
        repeat(2) { session.close() }
        assertThrows(IllegalStateException::class.java) { session.start() }
        assertEquals(emptyList<Any>(), runBlocking { session.fixes().toList() })
    }

    @Test
    fun `ten thousand starts and stops leave no thread, no listener and no memory behind`() {
        val session = session()
        fun cycles(n: Int) = repeat(n) {
            session.start()
            phone.sense(android.hardware.Sensor.TYPE_ACCELEROMETER, SensorClock.nowNs(), 0f, 0f, 9.81f)
            session.stop()
        }
        cycles(100)
        val threads = nSensorThreads()
        // Of a session kept of a hundred three times would be 15 MB.
        println("starts and stops by 5000, kB: ${flatMemory { cycles(5_000) }}")
        assertEquals(0, phone.nScans)
        assertTrue("$threads threads, then ${nSensorThreads()}", nSensorThreads() <= threads + 1)
        session.close()
    }

    @Test
    fun `a gap of an hour makes fixes stale, and a hint mends them`() {
        val session = session(Sensing(latencyMs = 0))
        session.start()
        val first = Walk.start
        val samples = Walk.samples.takeWhile { it.timeNs < first.timeNs + 20_000_000_000 }
        phone.clockTo(samples.first().timeNs)
        session.hint(PositionHint(first.point, 2.0, 0, first.timeNs))
        samples.forEach(phone::deliver)
        val before = session.fix()!!
        assertTrue(before.mode != FixMode.STALE)
        // A doze: an hour without a sample.
        val laterNs = samples.last().timeNs + HOUR_NS
        phone.clockTo(laterNs)
        val after = session.fixAt(laterNs)!!
        assertTrue("$after", after.mode == FixMode.STALE && after.radius68M > before.radius68M)
        // Awake again, the phone is held still; nothing is refused for being late.
        repeat(500) { k -> still(laterNs + k * 20_000_000L) }
        assertEquals(0uL, session.engineStatus().rejections.late)
        session.hint(PositionHint(first.point, 1.0, 0, laterNs + 10_000_000_000))
        assertTrue(session.fix()!!.mode != FixMode.STALE)
        session.close()
    }

    @Test
    fun `stamps of another clock are brought to ours, whatever the clock on the wall says`() {
        val second = 1_000_000_000L
        // On the clock of all samples, late by a batch: as it is.
        assertEquals(99 * second, StampAlignment().aligned(99 * second, 100 * second))
        // Since 1970, and without the time of sleep: moved by as much as the first one, for good.
        for (offset in listOf(1_700_000_000 * second, -40_000 * second)) {
            val alignment = StampAlignment()
            assertEquals(50_000 * second, alignment.aligned(50_000 * second + offset, 50_000 * second))
            assertEquals(50_002 * second, alignment.aligned(50_002 * second + offset, 50_003 * second))
        }
        // What was heard too long ago for the engine counts as heard when told.
        assertEquals(100 * second, BeaconScanner.told(99 * second, 100 * second))
        assertEquals(100 * second - 1, BeaconScanner.told(100 * second - 1, 100 * second))
        assertEquals(100 * second, BeaconScanner.told(101 * second, 100 * second))
    }

    @Test
    fun `no more scans are begun than Android answers`() {
        val budget = ScanBudget(2, 1_000)
        assertEquals(listOf(true, true, false, false, true, true), listOf(0L, 10, 20, 999, 1_000, 1_010).map(budget::take))
        assertTrue("a clock that begins anew", budget.take(0))
    }

    /** Three walks of a minute an hour; otherwise the phone lies still. */
    @Test
    fun `a day of samples through the batch API leaves memory flat`() {
        val walk = Walk.samples
        val lengthNs = walk.last().timeNs - walk.first().timeNs
        val batch = SampleBatch()
        Walk.openMap().use { map ->
            Positioner(map, 0).use { positioner ->
                fun push() {
                    positioner.pushSamples(batch.bytes())
                    batch.clear()
                }
                fun hour(startNs: Long) {
                    var nowNs = startNs
                    repeat(3) {
                        nowNs += 20_000_000
                        positioner.hint(PositionHint(Walk.start.point, 2.0, 0, nowNs))
                        for (record in walk) {
                            record.addTo(batch, nowNs + record.timeNs - walk.first().timeNs)
                            if (batch.size == 500) push()
                        }
                        push()
                        nowNs += lengthNs
                        val untilNs = startNs + (it + 1) * HOUR_NS / 3
                        while (nowNs < untilNs) {
                            nowNs += 20_000_000
                            batch.specificForce(nowNs, 0f, 0f, 9.81f)
                            batch.angularRate(nowNs, 0f, 0f, 0f)
                            batch.uncalibratedMagneticField(nowNs, 20f, 0f, -40f, 0f, 0f, 0f)
                            if (batch.size >= 500) push()
                        }
                        push()
                    }
                }
                val originNs = walk.first().timeNs
                val heldKb = flatMemory(6) { time -> repeat(4) { hour(originNs + (4 * time + it) * HOUR_NS) } }
                println("a day by four hours, kB: $heldKb")
                assertNotNull(positioner.fix())
                assertEquals(0uL, positioner.status().rejections.let { it.implausible + it.late + it.duplicate })
            }
        }
    }

    @Test
    fun `ten minutes through the phone's sensors leave memory flat`() {
        val session = session()
        session.start()
        val walk = Walk.samples
        val lengthNs = walk.last().timeNs - walk.first().timeNs + 20_000_000
        fun minute(k: Int) = walk.forEach { phone.deliver(it.at(it.timeNs + k * lengthNs)) }
        println("ten minutes by two, kB: ${flatMemory(5) { time -> repeat(2) { minute(2 * time + it) } }}")
        session.close()
    }

    private fun still(timeNs: Long) {
        phone.clockTo(timeNs)
        phone.sense(android.hardware.Sensor.TYPE_GYROSCOPE, timeNs, 0f, 0f, 0f)
        phone.sense(android.hardware.Sensor.TYPE_ACCELEROMETER, timeNs, 0f, 0f, 9.81f)
        phone.sense(android.hardware.Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, timeNs, 20f, 0f, -40f, 0f, 0f, 0f)
    }

    private fun Record.addTo(batch: SampleBatch, timeNs: Long) = at(timeNs).addTo(batch)

    private fun flatMemory(leastTimes: Int = 1, use: (time: Int) -> Unit) = FlatMemory.after(8_000, leastTimes) {
        use(it)
        phone.settle()
    }

    private fun nSensorThreads() = Thread.getAllStackTraces().keys.count { it.name == "fieldwalk-sensors" }

    private companion object {
        const val HOUR_NS = 3_600_000_000_000L
    }
}
