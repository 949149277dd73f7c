package org.fieldwalk.android

import kotlinx.coroutines.CoroutineScope
import kotlinx.coroutines.Dispatchers
import kotlinx.coroutines.cancel
import kotlinx.coroutines.launch
import org.fieldwalk.Fix
import org.fieldwalk.FixBits
import org.fieldwalk.PositionHint
import org.fieldwalk.SensorLoop
import org.fieldwalk.Walk
import org.junit.Assert.assertEquals
import org.junit.Assert.assertTrue
import org.junit.Test
import org.junit.runner.RunWith
import org.robolectric.RobolectricTestRunner

/** A recorded walk, delivered by Android's own callbacks, positioned by the real engine. */
@RunWith(RobolectricTestRunner::class)
class RecordedWalkTest {
    private val phone = SimulatedPhone().also { it.grantAll() }

    @Test
    fun `it gives the bits of fieldwalk replay`() {
        val bits = FixBits()
        var nFixes = 0
        fun take(fix: Fix?) {
            if (fix != null) {
                bits.push(fix)
                nFixes += 1
            }
        }
        phone.clockTo(Walk.records.first().timeNs)
        val session = Walk.openMap().use { map ->
            // No batch waits while a waypoint is passed.
            Fieldwalk.positioner(phone.context, map, sensing = Sensing(latencyMs = 0))
        }
        val reading = CoroutineScope(Dispatchers.Unconfined)
        reading.launch { session.fixes().collect(::take) }
        assertTrue(session.status.value.isRunning)
        assertTrue("samples go over JNI", SensorLoop.isSupported)
        var isStarted = false
        for (record in Walk.records) {
            if (record.kind != "waypoint") {
                phone.deliver(record)
                continue
            }
            if (!isStarted) {
                isStarted = true
                session.hint(PositionHint(record.point, 2.0, 0, record.timeNs))
            }
            take(session.fixAt(record.timeNs))
        }
        session.stop()
        take(session.fix())
        assertEquals(0, phone.nScans)
        reading.cancel()
        session.close()
        assertTrue("$nFixes fixes", nFixes > 50)
        assertEquals(Walk.digest, bits.hex())
    }
}
