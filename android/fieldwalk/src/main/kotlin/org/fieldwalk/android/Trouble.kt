package org.fieldwalk.android

import org.fieldwalk.ApiException
import org.fieldwalk.Missing
import org.fieldwalk.MissingInput

/** Something that keeps positions from being as good as they could be, and how to mend it. */
data class Trouble(
    val kind: TroubleKind,
    /** What it means, in English, for developers. */
    val explanation: String,
    /** What to do about it, in English. */
    val remedy: String,
    /** What to give to `Activity.requestPermissions`; empty when no permission is missing. */
    val permissions: List<String> = emptyList(),
    /** What the engine misses, for [TroubleKind.ENGINE]. */
    val missing: MissingInput? = null,
) {
    companion object {
        /** A map or another object that could not be opened, in the same words as all other troubles. */
        fun of(exception: ApiException): Trouble {
            val read = { name: String ->
                val getter = "get" + name.replaceFirstChar(Char::uppercaseChar)
                runCatching { exception.javaClass.getMethod(getter).invoke(exception) as String }.getOrDefault("")
            }
            return Trouble(TroubleKind.MAP, read("explanation"), read("remedy"))
        }

        internal fun of(missing: Missing) =
            Trouble(TroubleKind.ENGINE, missing.explanation, missing.remedy, missing = missing.what)
    }
}

/** What kind of trouble; new cases may come. */
enum class TroubleKind {
    /** The map could not be opened. */
    MAP,

    /** The device has no accelerometer, gyroscope or magnetometer. */
    SENSOR_ABSENT,

    /** No motion sensor speaks any more: they are switched off, or the app is not on the screen and has no service. */
    SENSORS_SILENT,

    /** The magnetometer says that its readings are not to be trusted. */
    CALIBRATION,

    /** A permission for Bluetooth is missing. */
    BLUETOOTH_PERMISSION,

    /** Bluetooth is switched off. */
    BLUETOOTH_OFF,

    /** The device has no Bluetooth of this kind. */
    BLUETOOTH_ABSENT,

    /** Android refused to scan. */
    BLUETOOTH_FAILED,

    /** The permission for the precise location is missing. */
    LOCATION_PERMISSION,

    /** The device's location switch is off, which silences beacons and WiFi. */
    LOCATION_OFF,

    /** WiFi is switched off, and scans with it; the map has access points. */
    WIFI_OFF,

    /** The device dozes: sensors stand still. */
    DOZING,

    /** The engine misses an input; which one is in [Trouble.missing]. */
    ENGINE,
}

/** Whether a session runs, and what it lacks. */
data class PositioningStatus(
    val isRunning: Boolean,
    /** What to mend, the gravest first. */
    val troubles: List<Trouble>,
)
