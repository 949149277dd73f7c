package org.fieldwalk

import java.nio.ByteBuffer
import java.nio.ByteOrder
import java.security.MessageDigest

/** The digest that `fieldwalk replay --bits` prints, of fixes as Kotlin sees them; defined in cli/src/bits.rs. */
class FixBits {
    private val digest = MessageDigest.getInstance("SHA-256")

    fun push(fix: Fix) {
        val place = fix.latitudeLongitude
        val bytes = ByteBuffer.allocate(8 + 4 + 12 * 8 + 1).order(ByteOrder.LITTLE_ENDIAN)
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
        digest.update(bytes.put(mode.toByte()).array())
    }

    fun hex(): String = (digest.clone() as MessageDigest).digest().joinToString("") { "%02x".format(it) }
}
