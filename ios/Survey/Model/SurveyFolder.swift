import Fieldwalk
import Foundation

/// A survey on disk, so that it outlives the app: the plan, a recording of every walk, and beside each what a recording
/// has no word for, which waypoints were taken back and when the walk stood still.
public struct SurveyFolder: Sendable {
    /// What is surveyed.
    public struct Floor: Codable, Sendable, Equatable {
        public var name: String
        public var ordinal: Int32
        /// What iOS is to listen for.
        public var beaconUUIDs: [UUID]

        public init(name: String, ordinal: Int32, beaconUUIDs: [UUID] = []) {
            (self.name, self.ordinal, self.beaconUUIDs) = (name, ordinal, beaconUUIDs)
        }
    }

    public let url: URL
    private var planFile: URL { url.appendingPathComponent("plan.geojson") }
    private var floorFile: URL { url.appendingPathComponent("floor.json") }

    public init(_ url: URL) { self.url = url }

    /// The survey of this app.
    public static func ofApp() throws -> Self {
        let support = try FileManager.default.url(
            for: .applicationSupportDirectory, in: .userDomainMask, appropriateFor: nil, create: true)
        return Self(support.appendingPathComponent("survey", isDirectory: true))
    }

    /// What is surveyed; nothing when there is no survey.
    public var floor: Floor? {
        guard let bytes = try? Data(contentsOf: floorFile) else { return nil }
        return try? JSONDecoder().decode(Floor.self, from: bytes)
    }

    /// Begins anew, with nothing but the plan; the survey that was here is dropped.
    ///
    /// - Throws: ``ApiError`` when the plan cannot be read, or is too large for a map: the survey that was here stays.
    public func create(plan: Data, floor: Floor) throws {
        _ = try Surveyor(plan: plan, name: floor.name, ordinal: floor.ordinal)
        let files = FileManager.default
        if files.fileExists(atPath: url.path) { try files.removeItem(at: url) }
        try files.createDirectory(at: url, withIntermediateDirectories: true)
        try plan.write(to: planFile)
        // Last, and whole or not at all: without it there is no survey.
        try JSONEncoder().encode(floor).write(to: floorFile, options: .atomic)
    }

    /// A surveyor of the plan, without a walk.
    func surveyor(of floor: Floor) throws -> Surveyor {
        try Surveyor(plan: Data(contentsOf: planFile), name: floor.name, ordinal: floor.ordinal)
    }

    /// The numbers of the walks that are recorded, in their order.
    func walks() -> [Int] {
        let files = (try? FileManager.default.contentsOfDirectory(at: url, includingPropertiesForKeys: nil)) ?? []
        return files.filter { $0.pathExtension == "mcap" }
            .compactMap { Int($0.deletingPathExtension().lastPathComponent) }.sorted()
    }

    /// Records a new walk, under a number that no other has.
    func beginWalk(on floor: Floor) throws -> WalkRecording {
        let number = (walks().last ?? 0) + 1
        let details = RecordingDetails(
            software: "Fieldwalk survey", floor: floor.name,
            startUnixMs: Int64(Date().timeIntervalSince1970 * 1000))
        // Of a walk that was dropped halfway.
        try? FileManager.default.removeItem(at: journal(of: number))
        let recorder = try Recorder(path: recording(of: number).path, details: details)
        return WalkRecording(number: number, recorder: recorder, journal: journal(of: number))
    }

    /// Drops a walk.
    func drop(_ number: Int) {
        for file in [recording(of: number), journal(of: number)] { try? FileManager.default.removeItem(at: file) }
    }

    /// Gives what was recorded to `surveyor`, whose walk has begun, as it was given at the time.
    ///
    /// - Throws: ``ApiError`` when the rest cannot be read; what came before it has been given then.
    func replay(_ number: Int, to surveyor: Surveyor) throws {
        let text = (try? String(contentsOf: journal(of: number), encoding: .utf8)) ?? ""
        // A line without its end was cut by the end of the app.
        let events = text.components(separatedBy: "\n").dropLast().map { $0.split(separator: " ") }
        func times(of kind: String) -> [Int64] {
            events.filter { $0.count == 2 && $0[0] == kind }.compactMap { Int64($0[1]) }
        }
        let (undone, pauses) = (Set(times(of: "undo")), times(of: "pause"))
        var lastNs = Int64.min
        let reader = try RecordingReader.open(path: recording(of: number).path)
        while let part = try reader.nextPart(maxSamples: .max) {
            // A part may end before its waypoint, where it is long: the pause is then in one that follows.
            let untilNs = part.waypoint?.timeNs
            if let untilNs, pauses.contains(where: { lastNs <= $0 && $0 < untilNs }) {
                try surveyor.pause()
                try surveyor.resume()
            }
            try surveyor.pushSamples(batch: part.samples)
            if let waypoint = part.waypoint, !undone.contains(waypoint.timeNs) {
                try surveyor.pushWaypoint(waypoint: waypoint)
            }
            lastNs = untilNs ?? lastNs
        }
    }

    private func recording(of number: Int) -> URL { url.appendingPathComponent("\(number).mcap") }

    private func journal(of number: Int) -> URL { url.appendingPathComponent("\(number).journal") }
}

/// A walk that is being recorded; samples and taps may come from several threads.
final class WalkRecording: Sendable {
    let number: Int
    private let recorder: Recorder
    private let journal: URL

    init(number: Int, recorder: Recorder, journal: URL) {
        (self.number, self.recorder, self.journal) = (number, recorder, journal)
    }

    func push(_ batch: Data) throws { try recorder.pushSamples(batch: batch) }

    func tap(_ waypoint: Waypoint) throws {
        try recorder.pushWaypoint(waypoint: waypoint)
        try recorder.flush()
    }

    func undo(_ waypoint: Waypoint) throws { try note("undo \(waypoint.timeNs)") }

    func pause(atNs timeNs: Int64) throws {
        try recorder.flush()
        try note("pause \(timeNs)")
    }

    func finish() throws { _ = try recorder.finish() }

    private func note(_ line: String) throws {
        // Made by the first line: most walks need none.
        if !FileManager.default.fileExists(atPath: journal.path) { try Data().write(to: journal) }
        let file = try FileHandle(forWritingTo: journal)
        defer { try? file.close() }
        try file.seekToEnd()
        try file.write(contentsOf: Data("\(line)\n".utf8))
        try file.synchronize()
    }
}
