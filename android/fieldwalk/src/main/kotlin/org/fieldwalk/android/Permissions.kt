package org.fieldwalk.android

import android.Manifest.permission
import android.content.Context
import android.content.pm.PackageManager
import android.location.LocationManager
import android.os.Build

/** Which permissions what needs, on which Android. */
object Permissions {
    /**
     * What hearing iBeacons needs. Before Android 12 the location permission is that for Bluetooth; since then both are
     * needed, for Android hides beacons from an app that promises not to derive a location from them.
     */
    fun forBeacons(sdk: Int = Build.VERSION.SDK_INT): List<String> =
        if (sdk >= Build.VERSION_CODES.S) listOf(permission.BLUETOOTH_SCAN) + forWifi() else forWifi()

    /**
     * What WiFi scans need. Since Android 12 the coarse location must be asked for with the fine one; the user may grant
     * the coarse one alone, which is not enough.
     */
    fun forWifi(): List<String> = listOf(permission.ACCESS_FINE_LOCATION, permission.ACCESS_COARSE_LOCATION)

    /** What hearing cards needs. */
    fun forCards(sdk: Int = Build.VERSION.SDK_INT): List<String> = forBeacons(sdk)

    /** What a positioner that runs while another app is on the screen needs: its notification, since Android 13. */
    fun forBackground(sdk: Int = Build.VERSION.SDK_INT): List<String> =
        forWifi() + if (sdk >= Build.VERSION_CODES.TIRAMISU) listOf(permission.POST_NOTIFICATIONS) else emptyList()

    internal fun isGranted(context: Context, name: String): Boolean =
        context.checkSelfPermission(name) == PackageManager.PERMISSION_GRANTED

    /** What keeps Bluetooth from being heard, of permissions. */
    internal fun bluetoothTrouble(context: Context): Trouble? {
        if (Build.VERSION.SDK_INT < Build.VERSION_CODES.S || isGranted(context, permission.BLUETOOTH_SCAN)) return null
        return Trouble(
            TroubleKind.BLUETOOTH_PERMISSION,
            "the permission for devices nearby is missing: no beacon is heard",
            "ask for the permission, and say that it serves to find beacons of the building",
            listOf(permission.BLUETOOTH_SCAN),
        )
    }

    /** What keeps beacons and WiFi from being heard, of location. */
    internal fun locationTrouble(context: Context): Trouble? {
        if (!isGranted(context, permission.ACCESS_FINE_LOCATION)) {
            return Trouble(
                TroubleKind.LOCATION_PERMISSION,
                "the permission for the precise location is missing: no beacon and no WiFi is heard",
                "ask for the precise location; nothing leaves the device",
                forWifi(),
            )
        }
        val location = context.getSystemService(LocationManager::class.java)
        if (Build.VERSION.SDK_INT < Build.VERSION_CODES.P || location == null || location.isLocationEnabled) return null
        return Trouble(
            TroubleKind.LOCATION_OFF,
            "the location is switched off: Android gives no beacons and no WiFi to apps",
            "ask the user to switch the location on in the quick settings",
        )
    }
}
