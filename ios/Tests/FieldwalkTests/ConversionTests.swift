import Foundation
import Testing

@testable import Fieldwalk

/// Core Motion's, Core Location's and Core Bluetooth's values in our units and frames.
struct ConversionTests {
    @Test func atRestTheAxisThatPointsUpReadsPlusG() {
        // Flat on a table, screen up: Core Motion says -1 g on z.
        let flat = CoreMotionConversion.specificForceMS2(accelerationG: SIMD3(0, 0, -1))
        #expect(flat.z == Float(9.80665) && abs(flat.x) + abs(flat.y) == 0)
        // Upright, the top up.
        #expect(CoreMotionConversion.specificForceMS2(accelerationG: SIMD3(0, -1, 0)).y == Float(9.80665))
        // In free fall there is none.
        let falling = CoreMotionConversion.specificForceMS2(
            gravityG: SIMD3(0, 0, -1), userAccelerationG: SIMD3(0, 0, 1))
        #expect(falling == .zero)
    }

    @Test func pushedToTheRightTheForceIsToTheRight() {
        // What Core Motion calls the user's acceleration has gravity's sign: speeding up to the right reads -x.
        let pushed = CoreMotionConversion.specificForceMS2(
            gravityG: SIMD3(0, 0, -1), userAccelerationG: SIMD3(-0.5, 0, 0))
        #expect(pushed.x == Float(0.5 * 9.80665) && pushed.z == Float(9.80665))
    }

    @Test func ratesFieldsAndPressuresKeepTheirAxes() {
        #expect(CoreMotionConversion.angularRateRadS(rotationRateRadS: SIMD3(1, -2, 3)) == SIMD3(1, -2, 3))
        #expect(CoreMotionConversion.magneticFieldUt(fieldUt: SIMD3(1, -20, 40), accuracy: 0) == SIMD3(1, -20, 40))
        #expect(CoreMotionConversion.pressureHpa(kilopascals: 101.325) == 1013.25)
    }

    @Test func aFieldThatIsNotCalibratedIsNone() {
        #expect(CoreMotionConversion.magneticFieldUt(fieldUt: SIMD3(1, 2, 3), accuracy: -1) == nil)
        #expect(CoreMotionConversion.magneticFieldUt(fieldUt: .zero, accuracy: 2) == nil)
    }

    @Test func theAttitudeTurnsTheDeviceIntoEastNorthUp() {
        let half = 0.5.squareRoot()
        // Flat, its top to the north: Core Motion's x axis points north, so the device's x, to the east, is its -y: a
        // quarter turn back about z.
        let toNorth = CoreMotionConversion.earthFromDevice(attitude: SIMD4(0, 0, -half, half))
        expect(turned(SIMD3(1, 0, 0), by: toNorth), SIMD3(1, 0, 0))
        expect(turned(SIMD3(0, 1, 0), by: toNorth), SIMD3(0, 1, 0))
        // Without any turn its right side points north, its top to the west.
        let toWest = CoreMotionConversion.earthFromDevice(attitude: SIMD4(0, 0, 0, 1))
        expect(turned(SIMD3(1, 0, 0), by: toWest), SIMD3(0, 1, 0))
        expect(turned(SIMD3(0, 1, 0), by: toWest), SIMD3(-1, 0, 0))
        // Then raised upright about its x axis: the top up, the screen to where the top's opposite was, east.
        let upright = CoreMotionConversion.earthFromDevice(attitude: SIMD4(half, 0, 0, half))
        expect(turned(SIMD3(0, 1, 0), by: upright), SIMD3(0, 0, 1))
        expect(turned(SIMD3(0, 0, 1), by: upright), SIMD3(1, 0, 0))
    }

    @Test func timesAreNanosecondsSinceBoot() {
        #expect(SensorClock.timeNs(secondsSinceBoot: 86_400.25) == 86_400_250_000_000)
        #expect(SensorClock.timeNs(secondsSinceBoot: .nan) == .min)
        #expect(SensorClock.timeNs(secondsSinceBoot: .infinity) == .min)
        let first = SensorClock.nowNs()
        #expect(first > 0 && SensorClock.nowNs() >= first)
    }

    @Test func beaconsWithoutAStrengthAreNone() throws {
        let uuid = try #require(UUID(uuidString: "007F80FF-6162-6364-6566-6768696A6B6C"))
        let heard = BeaconConversion.sample(uuid: uuid, major: 65535, minor: 7, rssiDbm: -63, timeNs: 9)
        #expect(heard == .ibeacon(timeNs: 9, uuid: uuid, major: 65535, minor: 7, rssiDbm: -63))
        #expect(uuid.bytes.prefix(5) == [0x00, 0x7f, 0x80, 0xff, 0x61])
        for (major, minor, rssi) in [(1, 1, 0), (1, 1, 5), (1, 1, -121), (65536, 1, -60), (1, -1, -60)] {
            #expect(BeaconConversion.sample(uuid: uuid, major: major, minor: minor, rssiDbm: rssi, timeNs: 9) == nil)
        }
    }

    @Test func aMapTellsTheUuidsOfItsBeacons() throws {
        #expect(try Walk.openMap().beaconUUIDs == Walk.beaconUUIDs)
    }

    @Test func aCardsFrameIsMadeWholeAgain() throws {
        let manufacturer = Data([0xff, 0xff, 0x10, 150] + [UInt8](repeating: 7, count: 22))
        let card = try #require(CardSighting(manufacturerData: manufacturer, rssiDbm: -70, timeNs: 5))
        #expect(card.frame.count == 31)
        #expect(card.frame.prefix(8) == Data([0x02, 0x01, 0x06, 0x1b, 0xff, 0xff, 0xff, 0x10]))
        #expect(card.rssiDbm == -70 && card.timeNs == 5)
        let round = try CardDecoder().decodeAdvertisement(advertisement: card.frame)
        #expect(round.cardId == 0x0707 && round.sequence == 7)
        #expect(CardSighting(manufacturerData: manufacturer.dropLast(), rssiDbm: -70, timeNs: 5) == nil)
        #expect(CardSighting(manufacturerData: Data([0x4c, 0]) + manufacturer.dropFirst(2), rssiDbm: -70, timeNs: 5) == nil)
        #expect(CardSighting(manufacturerData: manufacturer, rssiDbm: 127, timeNs: 5) == nil)
    }

    private func expect(_ a: SIMD3<Double>, _ b: SIMD3<Double>, sourceLocation: SourceLocation = #_sourceLocation) {
        let d = a - b
        #expect((d * d).sum() < 1e-24, "\(a), not \(b)", sourceLocation: sourceLocation)
    }

    /// q v q*, the rotation that the unit quaternion (x, y, z, w) stands for.
    private func turned(_ v: SIMD3<Double>, by q: SIMD4<Double>) -> SIMD3<Double> {
        let axis = SIMD3(q.x, q.y, q.z)
        let once = cross(axis, v) + q.w * v
        return v + 2 * cross(axis, once)
    }

    private func cross(_ a: SIMD3<Double>, _ b: SIMD3<Double>) -> SIMD3<Double> {
        SIMD3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)
    }
}
