package org.fieldwalk.android

import android.content.Context
import org.fieldwalk.ApiException
import org.fieldwalk.BuildingMap
import org.fieldwalk.PositionerOptions

/** Indoor positions on the device, offline: sensors of a phone in, a flow of fixes out. */
object Fieldwalk {
    /**
     * A session that follows one wearer on one floor; it has seen nothing yet.
     *
     * ```kotlin
     * val session = Fieldwalk.positioner(context, BuildingMap.open(mapFolder))
     * session.hint(PositionHint(tapped, radiusM = 2.0, floor = 0, timeNs = SensorClock.nowNs()))
     * session.fixes().collect { fix -> show(fix) }
     * ```
     *
     * @param map the building; it may be closed afterwards
     * @param floor the ordinal of the floor, the map's first by default
     * @throws ApiException when the map has no such floor, and when there is no such system
     */
    fun positioner(
        context: Context,
        map: BuildingMap,
        floor: Int = map.floors().first().ordinal,
        options: PositionerOptions = PositionerOptions(),
        sensing: Sensing = Sensing(),
    ): PositioningSession = PositioningSession(context.applicationContext, map, floor, options, sensing)
}

/** Which sensors and radios are used, and how often. */
data class Sensing(
    /**
     * How often specific force and angular rate are read, in Hz, 50 to 400. Over 200 Hz the app declares the permission
     * `HIGH_SAMPLING_RATE_SENSORS`; without it 200 Hz are asked for.
     */
    val motionHz: Int = 100,
    /**
     * Samples of so long are handed over at once, in ms, 0 to 100: the processor wakes less often, fixes are as much
     * later. Longer is of no use: the engine refuses samples that are more than 200 ms behind those of other sensors.
     */
    val latencyMs: Int = 50,
    /** How much of the time iBeacons are listened for. */
    val beacons: RadioUse = RadioUse.BALANCED,
    /** Whether WiFi is scanned, as often as Android allows: four times in two minutes. */
    val wifi: Boolean = true,
    /** Whether air pressure is read. */
    val pressure: Boolean = true,
)

/** How much of the time Bluetooth listens; the shares are those of Android's own scan modes. */
enum class RadioUse {
    /** Never: no permission is needed. */
    OFF,

    /** About a tenth of the time. */
    SPARING,

    /** About two fifths of the time. */
    BALANCED,

    /** Always, for surveys. */
    CONTINUOUS,
}
