package org.fieldwalk

import java.nio.ByteBuffer
import java.nio.ByteOrder
import java.security.MessageDigest

/** The digest that `fieldwalk replay --bits` prints, of fixes as Kotlin sees them; defined in cli/src/bits.rs. */
class FixBits {
    private val digest = MessageDigest.getInstance("SHA-256")

    fun push(fix: Fix) {
        val place = fix.latitudeLongitude
        val bytes = ByteBuffer.allocate(8 + 4 + 12 * 8 + 3).order(ByteOrder.LITTLE_ENDIAN)
        bytes.putLong(fix.timeNs).putInt(fix.floor)
        val numbers = listOf(
            fix.position.xM, fix.position.yM, fix.headingRad, fix.speedMS,
            fix.covarianceXxM2, fix.covarianceXyM2, fix.covarianceXyM2, fix.covarianceYyM2,
            fix.radius68M, fix.radius95M,
            place?.latitudeDeg ?: Double.NaN, place?.longitudeDeg ?: Double.NaN,
        )
        // toBits, not toRawBits: one NaN for all.
        numbers.forEach { bytes.putLong(it.toBits()) }
        val mode = when (fix.mode) {
            FixMode.STARTED -> 0
            FixMode.PARTICLE_FILTER -> 1
            FixMode.STALE -> 2
            FixMode.BEACON -> 3
            FixMode.PAUSED -> 4
            FixMode.OTHER -> 255
        }
        val attitude = when (fix.attitude) {
            Attitude.UNKNOWN -> 0
            Attitude.UPWARD_FORWARD_HORIZONTAL -> 1
            Attitude.UPWARD_FORWARD_INCLINED -> 2
            Attitude.UPWARD_NOT_FORWARD -> 3
            Attitude.NOT_UPWARD -> 4
        }
        val carryMode = when (fix.carryMode) {
            CarryMode.UNKNOWN -> 0
            CarryMode.HELD_UP -> 1
            CarryMode.HELD_UPRIGHT -> 2
            CarryMode.CALLING -> 3
            CarryMode.SWINGING -> 4
            CarryMode.FRONT_POCKET -> 5
            CarryMode.BACK_POCKET -> 6
            CarryMode.ON_TABLE -> 7
        }
        listOf(mode, attitude, carryMode).forEach { bytes.put(it.toByte()) }
        digest.update(bytes.array())
    }

    fun hex(): String = (digest.clone() as MessageDigest).digest().joinToString("") { "%02x".format(it) }
}
