#if canImport(CoreMotion) && !os(macOS)
    import CoreMotion
    import Foundation

    /// The phone's motion sensors, magnetometer and barometer, by Core Motion.
    ///
    /// The app's Info.plist needs `NSMotionUsageDescription` for the barometer. Core Motion delivers only while the app
    /// runs: in the foreground, and in the background as long as something else keeps the app running.
    public final class MotionSensors: SensorSource, @unchecked Sendable {
        private let rateHz: Double
        private let motion = CMMotionManager()
        private let altimeter = CMAltimeter()
        private let queue = OperationQueue()

        /// - Parameter rateHz: how often to sample, 50 to 100 Hz
        public init(rateHz: Double = 100) {
            self.rateHz = min(max(rateHz, 50), 100)
            queue.name = "org.fieldwalk.motion"
            queue.maxConcurrentOperationCount = 1
        }

        public func start(_ deliver: @escaping @Sendable (SensorSample) -> Void) throws {
            guard motion.isDeviceMotionAvailable else { throw SensorError.noMotionSensors }
            motion.deviceMotionUpdateInterval = 1 / rateHz
            // Of the frames that need no location permission the one that uses the magnetometer: with the other the
            // calibrated field stays zero.
            motion.startDeviceMotionUpdates(using: .xArbitraryCorrectedZVertical, to: queue) { data, _ in
                guard let data else { return }
                let timeNs = SensorClock.timeNs(secondsSinceBoot: data.timestamp)
                let gravity = data.gravity, user = data.userAcceleration
                let rate = data.rotationRate, field = data.magneticField
                // In this order: the engine takes rates before forces of the same instant.
                deliver(
                    .angularRate(
                        timeNs: timeNs,
                        vectorRadS: CoreMotionConversion.angularRateRadS(
                            rotationRateRadS: SIMD3(rate.x, rate.y, rate.z))))
                deliver(
                    .specificForce(
                        timeNs: timeNs,
                        vectorMS2: CoreMotionConversion.specificForceMS2(
                            gravityG: SIMD3(gravity.x, gravity.y, gravity.z),
                            userAccelerationG: SIMD3(user.x, user.y, user.z))))
                let fieldUt = CoreMotionConversion.magneticFieldUt(
                    fieldUt: SIMD3(field.field.x, field.field.y, field.field.z),
                    accuracy: Int(field.accuracy.rawValue))
                if let fieldUt {
                    deliver(.magneticField(timeNs: timeNs, vectorUt: fieldUt))
                }
            }
            guard CMAltimeter.isRelativeAltitudeAvailable() else { return }
            altimeter.startRelativeAltitudeUpdates(to: queue) { data, _ in
                guard let data else { return }
                deliver(
                    .pressure(
                        timeNs: SensorClock.timeNs(secondsSinceBoot: data.timestamp),
                        hpa: CoreMotionConversion.pressureHpa(kilopascals: data.pressure.doubleValue)))
            }
        }

        public func stop() {
            motion.stopDeviceMotionUpdates()
            altimeter.stopRelativeAltitudeUpdates()
        }
    }

    /// Why a sensor did not start.
    public enum SensorError: Error, Equatable, Sendable {
        /// The device has no accelerometer and gyroscope, as a simulator.
        case noMotionSensors
    }
#endif
