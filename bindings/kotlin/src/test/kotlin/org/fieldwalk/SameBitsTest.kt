package org.fieldwalk

import org.junit.jupiter.api.Assertions.assertArrayEquals
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertNotEquals
import org.junit.jupiter.api.Assertions.assertNull
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.junit.jupiter.params.ParameterizedTest
import org.junit.jupiter.params.provider.ValueSource

/** What Rust computes and what crosses into Kotlin is the same, to the bit. */
class SameBitsTest {
    @ParameterizedTest
    @ValueSource(ints = [1, 7, 100, 1_000_000])
    fun `a walk gives the bits of fieldwalk replay, whatever the size of batches`(batchSize: Int) {
        val bits = FixBits()
        val nFixes = Walk.openMap().use { map ->
            Positioner(map, 0).use { positioner -> replay(positioner, batchSize, bits) }
        }
        assertTrue(nFixes > 50, "$nFixes fixes")
        Walk.tell(bits.hex(), nFixes)
        assertEquals(Walk.digest, bits.hex())
    }

    @Test
    fun `another seed gives other bits`() {
        val bits = FixBits()
        Walk.openMap().use { map ->
            Positioner(map, 0, PositionerOptions(seed = 2uL)).use { replay(it, 100, bits) }
        }
        assertNotEquals(Walk.digest, bits.hex())
    }

    /** The same fix and digest stand in cli/src/bits.rs. */
    @Test
    fun `the digest of a fix is that of Rust`() {
        val fix = Fix(
            timeNs = 1_000_000, floor = 0, position = Point2(1.0, 2.0), latitudeLongitude = null,
            headingRad = 0.5, speedMS = 1.0, covarianceXxM2 = 1.0, covarianceXyM2 = 0.0, covarianceYyM2 = 1.0,
            radius68M = 1.5, radius95M = 2.5, mode = FixMode.PARTICLE_FILTER,
            attitude = Attitude.UPWARD_FORWARD_HORIZONTAL, carryMode = CarryMode.HELD_UP,
        )
        val digest = FixBits().also { it.push(fix) }.hex()
        assertEquals("716ca978f0fc2292c308af89090d3f0fe1177a1f151aed465a23722dd4058f29", digest)
    }

    @ParameterizedTest
    @ValueSource(strings = ["walk", "kinds"])
    fun `the encoder gives the bytes of the encoder for Rust`(name: String) {
        val batch = batchOf(Walk.records(name).filter { it.kind != "waypoint" })
        assertArrayEquals(Walk.batch(name), batch.bytes().toByteArray())
        batch.clear()
        assertEquals(0, batch.size)
        assertEquals(14, batch.bytes().remaining())
    }

    @Test
    fun `a snapshot goes on to the same bits`() {
        val (first, second) = Walk.samples.chunked(Walk.samples.size / 2 + 1)
        Walk.openMap().use { map ->
            Positioner(map, 0).use { whole ->
                Positioner(map, 0).use { restored ->
                    whole.hint(hint())
                    whole.pushSamples(batchOf(first).bytes())
                    assertNull(restored.fix())
                    restored.restore(whole.snapshot().toDirect())
                    assertEquals(whole.fix(), restored.fix())
                    val fixes = whole.pushSamples(batchOf(second).bytes())
                    assertTrue(fixes.size > 20, "${fixes.size} fixes")
                    assertEquals(fixes, restored.pushSamples(batchOf(second).bytes()))
                }
            }
        }
    }

    @Test
    fun `a map from bytes gives the fixes of a map from files`() {
        val files = Walk.mapFolder.listFiles { file -> file.extension == "safetensors" }!!.map { it.readBytes() }
        val fixes = listOf(Walk.openMap(), BuildingMap.fromFloorFiles("office", files)).map { map ->
            map.use {
                assertEquals("office", map.name())
                assertEquals(listOf(FloorInfo("F1", 0, 26.0, 20.0)), map.floors())
                Positioner(map, 0).use { positioner ->
                    positioner.hint(hint())
                    positioner.pushSamples(batchOf(Walk.samples).bytes())
                }
            }
        }
        assertTrue(fixes[0].isNotEmpty())
        assertEquals(fixes[0], fixes[1])
    }

    /** As `fieldwalk replay` does: a start at the first waypoint, a fix at every step, waypoint and the end. */
    private fun replay(positioner: Positioner, batchSize: Int, bits: FixBits): Int {
        var nFixes = 0
        var isStarted = false
        val batch = SampleBatch(capacityBytes = 64)
        fun take(fix: Fix?) {
            if (fix != null) {
                bits.push(fix)
                nFixes += 1
            }
        }
        fun push() {
            positioner.pushSamples(batch.bytes()).forEach(::take)
            batch.clear()
        }
        for (record in Walk.records) {
            if (record.kind != "waypoint") {
                record.addTo(batch)
                if (batch.size == batchSize) push()
                continue
            }
            push()
            if (!isStarted) {
                isStarted = true
                positioner.hint(PositionHint(record.point, 2.0, 0, record.timeNs))
            }
            // Fixes at waypoints in the past of the last sample are not given, here as there.
            take(positioner.fixAt(record.timeNs))
        }
        push()
        positioner.flush()
        take(positioner.fix())
        return nFixes
    }

    private fun hint() = Walk.records.first { it.kind == "waypoint" }.let { PositionHint(it.point, 2.0, 0, it.timeNs) }
}

/** A copy that the engine can read in place. */
fun ByteArray.toDirect(): java.nio.ByteBuffer = java.nio.ByteBuffer.allocateDirect(size).put(this).flip()
