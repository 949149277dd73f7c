import Foundation

/// What Core Location tells of an iBeacon, turned into a sample.
public enum BeaconConversion {
    /// A sighting of `CLBeacon`'s values; nothing when the strength is 0, Core Location's word for unknown, or a number
    /// is out of range.
    ///
    /// - Parameter timeNs: when Core Location told it. A `CLBeacon.timestamp` is up to a second older, and samples more
    ///   than 200 ms late are refused; a second's walk is little beside the reach of radio.
    public static func sample(uuid: UUID, major: Int, minor: Int, rssiDbm: Int, timeNs: Int64) -> SensorSample? {
        guard rssiDbm < 0, rssiDbm >= -120, let major = UInt16(exactly: major), let minor = UInt16(exactly: minor)
        else { return nil }
        return .ibeacon(timeNs: timeNs, uuid: uuid, major: major, minor: minor, rssiDbm: Float(rssiDbm))
    }
}

extension BuildingMap {
    /// The UUIDs of the map's iBeacons, each once: what ``IbeaconRanging`` is to listen for, since Core Location hears
    /// no iBeacon whose UUID it is not told.
    public var beaconUUIDs: [UUID] {
        ibeaconUuids().compactMap { bytes in
            bytes.count == 16 ? UUID(uuid: bytes.withUnsafeBytes { $0.loadUnaligned(as: uuid_t.self) }) : nil
        }
    }
}
