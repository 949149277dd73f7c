import Foundation

/// A source of sensor samples: the phone's sensors, its radio, a recording.
///
/// The phone's own are ``MotionSensors`` and ``IbeaconRanging``; an app or a test may bring others.
public protocol SensorSource: Sendable {
    /// Begins to hand every sample to `deliver`, from any thread, in order of time but for what comes late.
    ///
    /// - Throws: when the device has no such sensor.
    func start(_ deliver: @escaping @Sendable (SensorSample) -> Void) throws

    /// Ends it; a source may be started again. A sample that is under way may still be delivered.
    func stop()
}

/// One reading, in the units and the device frame of ``SampleBatch``, with its time on ``SensorClock``.
public enum SensorSample: Sendable, Equatable {
    /// Specific force in m/s²: +9.81 on the axis that points up at rest.
    case specificForce(timeNs: Int64, vectorMS2: SIMD3<Float>)
    /// Angular rate in rad/s, right-handed.
    case angularRate(timeNs: Int64, vectorRadS: SIMD3<Float>)
    /// Magnetic field in µT, with the operating system's hard-iron correction applied.
    case magneticField(timeNs: Int64, vectorUt: SIMD3<Float>)
    /// Magnetic field in µT before correction, and the operating system's estimate of the bias.
    case uncalibratedMagneticField(timeNs: Int64, vectorUt: SIMD3<Float>, biasUt: SIMD3<Float>)
    /// Air pressure in hPa.
    case pressure(timeNs: Int64, hpa: Float)
    /// An iBeacon heard.
    case ibeacon(timeNs: Int64, uuid: UUID, major: UInt16, minor: UInt16, rssiDbm: Float)
    /// A card's frame as it is on the air, 31 bytes; the system `card` follows them.
    case cardFrame(timeNs: Int64, frame: Data)

    /// When, in nanoseconds.
    public var timeNs: Int64 {
        switch self {
        case .specificForce(let timeNs, _), .angularRate(let timeNs, _), .magneticField(let timeNs, _),
            .uncalibratedMagneticField(let timeNs, _, _), .pressure(let timeNs, _),
            .ibeacon(let timeNs, _, _, _, _), .cardFrame(let timeNs, _):
            timeNs
        }
    }
}

extension SampleBatch {
    /// Adds `sample` at the end.
    public mutating func append(_ sample: SensorSample) {
        switch sample {
        case .specificForce(let timeNs, let v):
            specificForce(timeNs: timeNs, xMS2: v.x, yMS2: v.y, zMS2: v.z)
        case .angularRate(let timeNs, let v):
            angularRate(timeNs: timeNs, xRadS: v.x, yRadS: v.y, zRadS: v.z)
        case .magneticField(let timeNs, let v):
            magneticField(timeNs: timeNs, xUt: v.x, yUt: v.y, zUt: v.z)
        case .uncalibratedMagneticField(let timeNs, let v, let bias):
            uncalibratedMagneticField(
                timeNs: timeNs, xUt: v.x, yUt: v.y, zUt: v.z, biasXUt: bias.x, biasYUt: bias.y, biasZUt: bias.z)
        case .pressure(let timeNs, let hpa):
            pressure(timeNs: timeNs, pressureHpa: hpa)
        case .ibeacon(let timeNs, let uuid, let major, let minor, let rssiDbm):
            // A UUID has the sixteen bytes that the record asks for.
            try? ibeaconSighting(timeNs: timeNs, rssiDbm: rssiDbm, uuid: uuid.bytes, major: major, minor: minor)
        case .cardFrame(let timeNs, let frame):
            // What is not as long as a frame is none, and says nothing.
            try? cardFrame(timeNs: timeNs, frame: frame)
        }
    }
}

/// The clock of all samples: nanoseconds since the device booted, without the time that it slept.
///
/// Core Motion stamps its samples so.
public enum SensorClock {
    /// Now.
    public static func nowNs() -> Int64 {
        timeNs(secondsSinceBoot: ProcessInfo.processInfo.systemUptime)
    }

    /// Core Motion's `timestamp` in nanoseconds.
    public static func timeNs(secondsSinceBoot: Double) -> Int64 {
        // What is no time is given one that the engine refuses and counts.
        Int64(exactly: (secondsSinceBoot * 1e9).rounded()) ?? .min
    }
}

extension UUID {
    /// Its sixteen bytes in the order printed.
    var bytes: [UInt8] {
        withUnsafeBytes(of: uuid) { Array($0) }
    }
}
