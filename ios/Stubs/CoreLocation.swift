import Foundation

public enum CLAuthorizationStatus: Int32, Sendable {
    case notDetermined, restricted, denied, authorizedAlways, authorizedWhenInUse
}

open class CLBeaconIdentityConstraint: NSObject {
    public let uuid: UUID
    public init(uuid: UUID) { self.uuid = uuid }
}

open class CLBeacon: NSObject {
    public let uuid = UUID()
    public let major = NSNumber(value: 0)
    public let minor = NSNumber(value: 0)
    public let rssi = 0
    public let timestamp = Date()
}

open class CLLocationManager: NSObject {
    public weak var delegate: (any CLLocationManagerDelegate)?
    public var authorizationStatus: CLAuthorizationStatus { .notDetermined }
    public func requestWhenInUseAuthorization() {}
    public func startRangingBeacons(satisfying constraint: CLBeaconIdentityConstraint) {}
    public func stopRangingBeacons(satisfying constraint: CLBeaconIdentityConstraint) {}
}

/// Optional in Objective-C; here every method must be written, so that a misspelt one is found.
public protocol CLLocationManagerDelegate: AnyObject {
    func locationManagerDidChangeAuthorization(_ manager: CLLocationManager)
    func locationManager(
        _ manager: CLLocationManager, didRange beacons: [CLBeacon],
        satisfying beaconConstraint: CLBeaconIdentityConstraint)
    func locationManager(
        _ manager: CLLocationManager, didFailRangingFor beaconConstraint: CLBeaconIdentityConstraint,
        error: any Error)
}
