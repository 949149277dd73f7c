/// Core Motion's units, signs and frames turned into Fieldwalk's; the only place that does so.
///
/// Both device frames are the same: x to the right of the screen, y to its top, z out of it. Apart are:
///
/// | | Core Motion | Fieldwalk |
/// |---|---|---|
/// | acceleration | units of g, −1 on the axis that points up at rest | specific force in m/s², +9.81 there |
/// | rotation rate | rad/s, right-handed | the same |
/// | magnetic field | µT; zero while it is not calibrated | µT; no sample then |
/// | air pressure | kPa | hPa |
/// | attitude | from the device to x north, y west, z up | to x east, y north, z up |
public enum CoreMotionConversion {
    /// Core Motion's g, in m/s².
    public static let standardGravityMS2 = 9.80665

    /// The specific force of `CMAccelerometerData.acceleration`, in m/s².
    public static func specificForceMS2(accelerationG: SIMD3<Double>) -> SIMD3<Float> {
        SIMD3<Float>(accelerationG * -standardGravityMS2)
    }

    /// The specific force of a `CMDeviceMotion`, which tells gravity and the rest apart, in m/s².
    public static func specificForceMS2(gravityG: SIMD3<Double>, userAccelerationG: SIMD3<Double>) -> SIMD3<Float> {
        specificForceMS2(accelerationG: gravityG + userAccelerationG)
    }

    /// `CMDeviceMotion.rotationRate` or `CMGyroData.rotationRate`, in rad/s.
    public static func angularRateRadS(rotationRateRadS: SIMD3<Double>) -> SIMD3<Float> {
        SIMD3<Float>(rotationRateRadS)
    }

    /// `CMDeviceMotion.magneticField`, in µT; nothing while its accuracy is "uncalibrated" (-1) or the field is zero,
    /// which it is nowhere on Earth.
    public static func magneticFieldUt(fieldUt: SIMD3<Double>, accuracy: Int) -> SIMD3<Float>? {
        accuracy < 0 || fieldUt == .zero ? nil : SIMD3<Float>(fieldUt)
    }

    /// `CMAltitudeData.pressure`, in hPa.
    public static func pressureHpa(kilopascals: Double) -> Float {
        Float(kilopascals * 10)
    }

    /// `CMAttitude.quaternion` as (x, y, z, w), taken with the reference frame `xMagneticNorthZVertical` or
    /// `xTrueNorthZVertical`: the rotation from the device to x east, y north, z up, as (x, y, z, w).
    ///
    /// Turned by it, a vector of the device frame is one of that frame. The engine does not use it: it follows the
    /// phone's attitude by itself. It is for apps that draw where the phone points.
    public static func earthFromDevice(attitude q: SIMD4<Double>) -> SIMD4<Double> {
        // A quarter turn about z, which takes north from x to y, after the attitude.
        let half = 0.5.squareRoot()
        return SIMD4(half * (q.x - q.y), half * (q.y + q.x), half * (q.z + q.w), half * (q.w - q.z))
    }
}
