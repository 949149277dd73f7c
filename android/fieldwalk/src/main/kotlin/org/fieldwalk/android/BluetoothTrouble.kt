package org.fieldwalk.android

import android.bluetooth.BluetoothManager
import android.content.Context
import android.content.pm.PackageManager

/** What keeps Bluetooth from being heard. */
internal object BluetoothTrouble {
    fun of(context: Context): Trouble? {
        val adapter = context.getSystemService(BluetoothManager::class.java)?.adapter
        if (adapter == null || !context.packageManager.hasSystemFeature(PackageManager.FEATURE_BLUETOOTH_LE)) {
            return Trouble(
                TroubleKind.BLUETOOTH_ABSENT, "this device has no Bluetooth Low Energy: no beacon is heard",
                "nothing to do; positions come from the magnetic field and steps",
            )
        }
        Permissions.bluetoothTrouble(context)?.let { return it }
        if (!adapter.isEnabled) {
            return Trouble(
                TroubleKind.BLUETOOTH_OFF, "Bluetooth is switched off: no beacon is heard",
                "ask the user to switch Bluetooth on",
            )
        }
        return Permissions.locationTrouble(context)
    }
}
