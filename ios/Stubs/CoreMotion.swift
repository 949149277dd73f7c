import Foundation

public struct CMAcceleration { public var x = 0.0, y = 0.0, z = 0.0 }
public struct CMRotationRate { public var x = 0.0, y = 0.0, z = 0.0 }
public struct CMMagneticField { public var x = 0.0, y = 0.0, z = 0.0 }

public enum CMMagneticFieldCalibrationAccuracy: Int32 {
    case uncalibrated = -1
    case low, medium, high
}

public struct CMCalibratedMagneticField {
    public var field = CMMagneticField()
    public var accuracy = CMMagneticFieldCalibrationAccuracy.uncalibrated
}

public struct CMAttitudeReferenceFrame: OptionSet, Sendable {
    public let rawValue: UInt
    public init(rawValue: UInt) { self.rawValue = rawValue }
    public static let xArbitraryZVertical = Self(rawValue: 1)
    public static let xArbitraryCorrectedZVertical = Self(rawValue: 2)
}

open class CMLogItem: NSObject {
    public let timestamp: TimeInterval = 0
}

open class CMDeviceMotion: CMLogItem {
    public let gravity = CMAcceleration()
    public let userAcceleration = CMAcceleration()
    public let rotationRate = CMRotationRate()
    public let magneticField = CMCalibratedMagneticField()
}

public typealias CMDeviceMotionHandler = (CMDeviceMotion?, (any Error)?) -> Void

open class CMMotionManager: NSObject {
    public var isDeviceMotionAvailable: Bool { false }
    public var deviceMotionUpdateInterval: TimeInterval = 0
    public func startDeviceMotionUpdates(
        using referenceFrame: CMAttitudeReferenceFrame, to queue: OperationQueue,
        withHandler handler: @escaping CMDeviceMotionHandler
    ) {}
    public func stopDeviceMotionUpdates() {}
}

open class CMAltitudeData: CMLogItem {
    public let pressure = NSNumber(value: 0)
}

open class CMAltimeter: NSObject {
    public class func isRelativeAltitudeAvailable() -> Bool { false }
    public func startRelativeAltitudeUpdates(
        to queue: OperationQueue, withHandler handler: @escaping (CMAltitudeData?, (any Error)?) -> Void
    ) {}
    public func stopRelativeAltitudeUpdates() {}
}
