import Fieldwalk
import Foundation

/// Fieldwalk's surveyor as the app's engine; every walk is on the disk from its first second.
public final class SurveyorEngine: SurveyEngine, @unchecked Sendable {
    public let floor: SurveyFolder.Floor
    private let folder: SurveyFolder
    private let surveyor: Surveyor

    /// Guards what follows: samples come on the sensors' threads.
    private let lock = NSLock()
    private var walk: WalkRecording?
    private var isPaused = false
    /// The numbers of the walks that have ended, as the surveyor has them.
    private var ended: [Int] = []

    /// The survey in `folder`, without its walks: ``restore()`` takes them in.
    ///
    /// - Throws: when there is no survey; ``ApiError`` when its plan cannot be read, or is too large for a map.
    public init(folder: SurveyFolder) throws {
        guard let floor = folder.floor else { throw CocoaError(.fileNoSuchFile) }
        surveyor = try folder.surveyor(of: floor)
        (self.folder, self.floor) = (folder, floor)
    }

    public func plan() -> PlanLines {
        let drawing = surveyor.drawing()
        return PlanLines(
            widthM: drawing.widthM, heightM: drawing.heightM,
            rings: drawing.outline + drawing.units.flatMap(\.rings), lines: drawing.walls + drawing.pathways)
    }

    public func restore() throws -> [WalkSummary] {
        try folder.walks().map { number in
            try surveyor.beginWalk(name: "walk \(number)")
            let replayed = Result { try folder.replay(number, to: surveyor) }
            let report = try surveyor.endWalk()
            if report.isUsed {
                lock.withLock { ended.append(number) }
            } else if case .success = replayed {
                // Cut in its first seconds, it holds nothing. What cannot be read stays where it is.
                folder.drop(number)
            }
            var summary = WalkSummary(report)
            if case .failure(let error) = replayed { summary.remedy = "walk \(number): \(remedy(of: error))" }
            return summary
        }
    }

    public func beginWalk(_ name: String) throws {
        try surveyor.beginWalk(name: name)
        do {
            let walk = try folder.beginWalk(on: floor)
            lock.withLock { (self.walk, isPaused) = (walk, false) }
        } catch {
            _ = try? surveyor.discardWalk()
            throw error
        }
    }

    public func push(_ batch: Data) throws {
        try surveyor.pushSamples(batch: batch)
        try lock.withLock { isPaused ? nil : walk }?.push(batch)
    }

    public func tap(_ point: Point2, atNs timeNs: Int64) throws {
        let waypoint = Waypoint(timeNs: timeNs, point: point)
        try surveyor.pushWaypoint(waypoint: waypoint)
        do {
            try recording?.tap(waypoint)
        } catch {
            _ = try? surveyor.undoWaypoint()
            throw error
        }
    }

    public func undoTap() throws -> Point2? {
        guard let waypoint = try surveyor.undoWaypoint() else { return nil }
        do {
            try recording?.undo(waypoint)
        } catch {
            try? surveyor.pushWaypoint(waypoint: waypoint)
            throw error
        }
        return waypoint.point
    }

    public func pause(atNs timeNs: Int64) throws {
        try recording?.pause(atNs: timeNs)
        try surveyor.pause()
        lock.withLock { isPaused = true }
    }

    public func resume() throws {
        try surveyor.resume()
        lock.withLock { isPaused = false }
    }

    public func endWalk() throws -> WalkSummary {
        let walk = lock.withLock { () -> WalkRecording? in
            defer { self.walk = nil }
            return self.walk
        }
        let finished = Result { try walk?.finish() }
        var summary = WalkSummary(try surveyor.endWalk())
        guard let walk else { return summary }
        if summary.isUsed {
            lock.withLock { ended.append(walk.number) }
            // The surveyor has the walk all the same.
            if case .failure(let error) = finished { summary.remedy = remedy(of: error) }
        } else {
            folder.drop(walk.number)
        }
        return summary
    }

    public func undoWalk() throws -> Bool {
        guard try surveyor.undoWalk() != nil else { return false }
        if let number = lock.withLock({ ended.popLast() }) { folder.drop(number) }
        return true
    }

    /// What is recorded now.
    private var recording: WalkRecording? { lock.withLock { walk } }

    public func progress() throws -> WalkProgress {
        let status = try surveyor.status()
        // How the phone is carried comes first: the surveyor mends it in the next step.
        let remedies = [status.carryWarning?.remedy].compactMap { $0 } + status.missing.map(\.remedy)
        return WalkProgress(nSteps: Int(status.nSteps), remedies: remedies)
    }

    public func coverage() throws -> CoverageGrid {
        let coverage = try surveyor.coverage()
        return CoverageGrid(
            openM2: coverage.totals.openM2, coveredM2: coverage.totals.coveredM2, cellM: coverage.cellM,
            nColumns: Int(coverage.nColumns), nRows: Int(coverage.nRows), nodes: [UInt8](coverage.nodes))
    }

    public func build() throws -> BuiltMap {
        let surveyed = try surveyor.build()
        let accuracy = surveyed.expectedAccuracy()
        let map = try BuildingMap.ofSurvey(name: floor.name, floors: [surveyed])
        return BuiltMap(
            file: try map.export(), expectedMedianM: accuracy?.medianM, expectedP90M: accuracy?.p90M)
    }
}

extension WalkSummary {
    fileprivate init(_ report: WalkReport) {
        self.init(isUsed: report.isUsed, remedy: report.remedy, nSteps: Int(report.nSteps), routeM: report.routeM)
    }
}
