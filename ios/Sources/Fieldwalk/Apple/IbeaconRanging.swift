#if canImport(CoreLocation) && !os(macOS)
    import CoreLocation
    import Foundation

    /// iBeacons of known UUIDs, ranged by Core Location about once a second.
    ///
    /// Core Bluetooth hides iBeacons, so this is the only way to hear them. The app's Info.plist needs
    /// `NSLocationWhenInUseUsageDescription`. Ranging works in the foreground; in the background iOS allows it for some
    /// seconds after a beacon region is entered, or while the app holds its own location updates.
    public final class IbeaconRanging: SensorSource {
        /// What keeps beacons from being heard; the session goes on without them.
        public enum Trouble: Error, Equatable, Sendable {
            /// The user has not allowed the app to use the location; the app's settings change that.
            case notAuthorized
            /// Ranging failed: Bluetooth or location services are off, or the device cannot range.
            case rangingFailed
        }

        private let listener: Listener

        /// - Parameters:
        ///   - uuids: what to listen for: ``BuildingMap/beaconUUIDs``
        ///   - report: called on the main thread with what keeps beacons from being heard
        public init(uuids: [UUID], report: @escaping @Sendable (Trouble) -> Void = { _ in }) {
            listener = Listener(
                constraints: uuids.map { CLBeaconIdentityConstraint(uuid: $0) }, report: report)
        }

        public func start(_ deliver: @escaping @Sendable (SensorSample) -> Void) {
            DispatchQueue.main.async { [listener] in listener.start(deliver) }
        }

        public func stop() {
            DispatchQueue.main.async { [listener] in listener.stop() }
        }
    }

    /// On the main thread only: Core Location calls back on the thread that made its manager.
    private final class Listener: NSObject, CLLocationManagerDelegate, @unchecked Sendable {
        private let constraints: [CLBeaconIdentityConstraint]
        private let report: @Sendable (IbeaconRanging.Trouble) -> Void
        private var manager: CLLocationManager?
        private var deliver: (@Sendable (SensorSample) -> Void)?

        init(
            constraints: [CLBeaconIdentityConstraint],
            report: @escaping @Sendable (IbeaconRanging.Trouble) -> Void
        ) {
            self.constraints = constraints
            self.report = report
        }

        func start(_ deliver: @escaping @Sendable (SensorSample) -> Void) {
            guard !constraints.isEmpty else { return }
            self.deliver = deliver
            let manager = CLLocationManager()
            self.manager = manager
            // Core Location answers with the authorization at once.
            manager.delegate = self
        }

        func stop() {
            constraints.forEach { manager?.stopRangingBeacons(satisfying: $0) }
            manager?.delegate = nil
            manager = nil
            deliver = nil
        }

        func locationManagerDidChangeAuthorization(_ manager: CLLocationManager) {
            switch manager.authorizationStatus {
            case .notDetermined:
                manager.requestWhenInUseAuthorization()
            case .authorizedWhenInUse, .authorizedAlways:
                constraints.forEach { manager.startRangingBeacons(satisfying: $0) }
            default:
                report(.notAuthorized)
            }
        }

        func locationManager(
            _ manager: CLLocationManager, didRange beacons: [CLBeacon],
            satisfying beaconConstraint: CLBeaconIdentityConstraint
        ) {
            let timeNs = SensorClock.nowNs()
            for beacon in beacons {
                let sample = BeaconConversion.sample(
                    uuid: beacon.uuid, major: beacon.major.intValue, minor: beacon.minor.intValue,
                    rssiDbm: beacon.rssi, timeNs: timeNs)
                if let sample { deliver?(sample) }
            }
        }

        func locationManager(
            _ manager: CLLocationManager, didFailRangingFor beaconConstraint: CLBeaconIdentityConstraint,
            error: any Error
        ) {
            report(.rangingFailed)
        }
    }
#endif
