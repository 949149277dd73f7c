package org.fieldwalk.android

import android.bluetooth.le.ScanCallback
import kotlinx.coroutines.CoroutineScope
import kotlinx.coroutines.Dispatchers
import kotlinx.coroutines.cancel
import kotlinx.coroutines.launch
import org.junit.After
import org.junit.Assert.assertEquals
import org.junit.Assert.assertNotSame
import org.junit.Assert.assertNull
import org.junit.Assert.assertSame
import org.junit.Assert.assertTrue
import org.junit.Before
import org.junit.Test
import org.junit.runner.RunWith
import org.robolectric.RobolectricTestRunner

/** Scans for beacons and for cards go on by themselves, whatever Android does to them. */
@RunWith(RobolectricTestRunner::class)
class KeptScanTest {
    private val phone = SimulatedPhone()
    private val cards = CardScanner(phone.context)
    private val reader = CoroutineScope(Dispatchers.Unconfined)
    private val sensors = PhoneSensors(phone.context, push = {}, report = { troubles = it })
    @Volatile private var troubles = emptyList<Trouble>()

    /** The starts of one test are no longer counted in the next. */
    @Before
    fun later() = phone.pass(++nTests * 100_000L)

    @After
    fun end() {
        reader.cancel()
        sensors.stop()
    }

    private fun listen() {
        reader.launch { cards.sightings().collect { } }
        phone.settle()
    }

    private fun failScan() {
        phone.scans.single().onScanFailed(ScanCallback.SCAN_FAILED_INTERNAL_ERROR)
        phone.settle()
    }

    @Test
    fun `both are renewed before Android turns them down`() {
        phone.grantAll()
        for (begin in listOf({ sensors.start() }, { listen() })) {
            begin()
            val first = phone.scans.single()
            phone.pass(8 * MINUTE_MS)
            assertSame(first, phone.scans.single())
            phone.pass(3 * MINUTE_MS / 2)
            val second = phone.scans.single()
            assertNotSame(first, second)
            phone.pass(8 * MINUTE_MS)
            assertSame(second, phone.scans.single())
            sensors.stop()
        }
    }

    @Test
    fun `cards are heard once the permission is there, and again after Bluetooth was off`() {
        assertEquals(TroubleKind.BLUETOOTH_PERMISSION, cards.trouble()!!.kind)
        listen()
        assertEquals(0, phone.nScans)
        phone.grantAll()
        phone.pass(2_000)
        assertEquals(1, phone.nScans)
        val before = phone.scans.single()
        phone.switchBluetooth(false)
        phone.settle()
        assertEquals(TroubleKind.BLUETOOTH_OFF, cards.trouble()!!.kind)
        phone.switchBluetooth(true)
        phone.settle()
        assertNull(cards.trouble())
        assertNotSame(before, phone.scans.single())
        reader.cancel()
        assertEquals(0, phone.nScans)
    }

    @Test
    fun `a scan that fails is told of, and begun again as often as Android allows`() {
        phone.grantAll()
        fun ofBeacons() = troubles.find { it.kind == TroubleKind.BLUETOOTH_FAILED }
        val both = listOf({ sensors.start() } to ::ofBeacons, { listen() } to cards::trouble)
        for ((begin, trouble) in both) {
            begin()
            repeat(3) {
                failScan()
                phone.pass(1_000)
                assertEquals(TroubleKind.BLUETOOTH_FAILED, trouble()?.kind)
                assertEquals(1, phone.nScans)
            }
            // The fifth in 30 s would be one too many.
            failScan()
            phone.pass(1_000)
            assertEquals(0, phone.nScans)
            assertTrue(trouble()!!.explanation.contains("error 3"))
            phone.pass(30_000)
            assertEquals(1, phone.nScans)
            // It goes on.
            phone.pass(1_000)
            assertNull(trouble())
            sensors.stop()
            phone.pass(30_000)
        }
    }

    private companion object {
        const val MINUTE_MS = 60_000L
        var nTests = 0
    }
}
