import Foundation

@testable import Fieldwalk

/// The folder that tests/examples/walk_for_bindings.rs has written; it says what is in it.
enum Walk {
    static let folder: URL = {
        guard let path = ProcessInfo.processInfo.environment["FIELDWALK_WALK"] else {
            fatalError("run by: cargo xtask swift")
        }
        return URL(fileURLWithPath: path)
    }()

    static let mapFolder = folder.appendingPathComponent("map")
    static let records = read("walk")
    static let samples = records.filter { !$0.isWaypoint }
    /// The UUIDs of the iBeacons that the walker heard.
    static let beaconUUIDs = Set(samples.compactMap(\.beaconUUID)).sorted { $0.uuidString < $1.uuidString }
    /// What `fieldwalk replay --bits` says of the walk.
    static let digest = String(text("walk.bits").prefix { $0 != " " })

    /// Leaves the digest of the walk's fixes as Swift found it, for the report of `cargo xtask test`.
    static func tell(digest: String, nFixes: Int) throws {
        let file = folder.appendingPathComponent("swift.bits")
        try Data("\(digest) \(nFixes)\n".utf8).write(to: file, options: .atomic)
    }

    static func read(_ name: String) -> [Record] {
        text("\(name).samples").split(separator: "\n").map(Record.init)
    }

    static func batch(_ name: String) -> Data {
        try! Data(contentsOf: folder.appendingPathComponent("\(name).batch"))
    }

    static func openMap() throws -> BuildingMap {
        try BuildingMap.open(path: mapFolder.path)
    }

    /// The floors' files of the map.
    static func floorFiles() throws -> [URL] {
        let files = try FileManager.default.contentsOfDirectory(at: mapFolder, includingPropertiesForKeys: nil)
        return files.filter { $0.pathExtension == "safetensors" }
    }

    /// A positioner that knows where the walk starts.
    static func placed(seed: UInt64 = 1) throws -> Positioner {
        let positioner = try Positioner(map: openMap(), floor: 0, options: PositionerOptions(seed: seed))
        try positioner.hint(hint: start)
        return positioner
    }

    static let start: PositionHint = {
        let first = records.first { $0.isWaypoint }!
        return PositionHint(point: first.point, radiusM: 2, floor: 0, timeNs: first.timeNs)
    }()

    private static func text(_ name: String) -> String {
        try! String(contentsOf: folder.appendingPathComponent(name), encoding: .utf8)
    }
}

/// A line of a `.samples` file.
struct Record: Sendable {
    let timeNs: Int64
    let kind: String
    private let fields: [String]

    init(_ line: Substring) {
        let words = line.split(separator: " ").map(String.init)
        (timeNs, kind, fields) = (Int64(words[0])!, words[1], Array(words[2...]))
    }

    var isWaypoint: Bool { kind == "waypoint" }
    var point: Point2 { Point2(xM: double(0), yM: double(1)) }

    func add(to batch: inout SampleBatch) {
        switch kind {
        case "specific_force":
            batch.specificForce(timeNs: timeNs, xMS2: float(0), yMS2: float(1), zMS2: float(2))
        case "angular_rate":
            batch.angularRate(timeNs: timeNs, xRadS: float(0), yRadS: float(1), zRadS: float(2))
        case "magnetic_field":
            batch.magneticField(timeNs: timeNs, xUt: float(0), yUt: float(1), zUt: float(2))
        case "uncalibrated_magnetic_field":
            batch.uncalibratedMagneticField(
                timeNs: timeNs, xUt: float(0), yUt: float(1), zUt: float(2),
                biasXUt: float(3), biasYUt: float(4), biasZUt: float(5))
        case "pressure":
            batch.pressure(timeNs: timeNs, pressureHpa: float(0))
        case "ble_sighting":
            try! batch.bleSighting(timeNs: timeNs, rssiDbm: float(0), address: bytes(1))
        case "ibeacon_sighting":
            try! batch.ibeaconSighting(
                timeNs: timeNs, rssiDbm: float(0), uuid: bytes(1), major: UInt16(fields[2])!, minor: UInt16(fields[3])!)
        case "card_frame":
            try! batch.cardFrame(timeNs: timeNs, frame: bytes(0))
        case "wifi_sighting":
            try! batch.wifiSighting(timeNs: timeNs, rssiDbm: float(0), bssid: bytes(1))
        default:
            fatalError("a record called \(kind)")
        }
    }

    /// The record as a sensor gives it; nothing for what a phone of Apple's does not tell.
    var sample: SensorSample? {
        switch kind {
        case "specific_force": .specificForce(timeNs: timeNs, vectorMS2: vector(0))
        case "angular_rate": .angularRate(timeNs: timeNs, vectorRadS: vector(0))
        case "magnetic_field": .magneticField(timeNs: timeNs, vectorUt: vector(0))
        case "uncalibrated_magnetic_field":
            .uncalibratedMagneticField(timeNs: timeNs, vectorUt: vector(0), biasUt: vector(3))
        case "pressure": .pressure(timeNs: timeNs, hpa: float(0))
        case "ibeacon_sighting":
            .ibeacon(
                timeNs: timeNs, uuid: UUID(uuid: bytes(1).withUnsafeBytes { $0.loadUnaligned(as: uuid_t.self) }),
                major: UInt16(fields[2])!, minor: UInt16(fields[3])!, rssiDbm: float(0))
        case "card_frame": .cardFrame(timeNs: timeNs, frame: Data(bytes(0)))
        default: nil
        }
    }

    var beaconUUID: UUID? {
        if case .ibeacon(_, let uuid, _, _, _) = sample { uuid } else { nil }
    }

    private func float(_ k: Int) -> Float { Float(bitPattern: UInt32(fields[k], radix: 16)!) }
    private func double(_ k: Int) -> Double { Double(bitPattern: UInt64(fields[k], radix: 16)!) }
    private func vector(_ k: Int) -> SIMD3<Float> { SIMD3(float(k), float(k + 1), float(k + 2)) }

    private func bytes(_ k: Int) -> [UInt8] {
        let digits = Array(fields[k])
        return stride(from: 0, to: digits.count, by: 2).map { UInt8(String(digits[$0..<$0 + 2]), radix: 16)! }
    }
}

func batchOf(_ records: some Sequence<Record>) -> Data {
    var batch = SampleBatch()
    records.forEach { $0.add(to: &batch) }
    return batch.bytes
}

extension Array {
    func chunked(_ size: Int) -> [[Element]] {
        stride(from: 0, to: count, by: size).map { Array(self[$0..<Swift.min($0 + size, count)]) }
    }
}
