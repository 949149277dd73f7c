import Fieldwalk
import Foundation

/// Fieldwalk's surveyor as the app's engine.
public final class SurveyorEngine: SurveyEngine {
    private let surveyor: Surveyor
    private let floor: String

    /// - Parameters:
    ///   - plan: the floor plan in GeoJSON
    ///   - floor: the floor's name
    ///   - ordinal: its number, 0 being the ground floor
    /// - Throws: ``ApiError`` when the plan cannot be read, or is too large for a map.
    public init(plan: Data, floor: String, ordinal: Int32) throws {
        surveyor = try Surveyor(plan: plan, name: floor, ordinal: ordinal)
        self.floor = floor
    }

    public func plan() -> PlanLines {
        let drawing = surveyor.drawing()
        return PlanLines(
            widthM: drawing.widthM, heightM: drawing.heightM,
            rings: drawing.outline + drawing.units.flatMap(\.rings), lines: drawing.walls + drawing.pathways)
    }

    public func beginWalk(_ name: String) throws { try surveyor.beginWalk(name: name) }

    public func push(_ batch: Data) throws { try surveyor.pushSamples(batch: batch) }

    public func tap(_ point: Point2, atNs timeNs: Int64) throws {
        try surveyor.pushWaypoint(waypoint: Waypoint(timeNs: timeNs, point: point))
    }

    public func undoTap() throws -> Point2? { try surveyor.undoWaypoint()?.point }

    public func pause() throws { try surveyor.pause() }

    public func resume() throws { try surveyor.resume() }

    public func endWalk() throws -> WalkSummary {
        let report = try surveyor.endWalk()
        return WalkSummary(
            isUsed: report.isUsed, remedy: report.remedy, nSteps: Int(report.nSteps), routeM: report.routeM)
    }

    public func undoWalk() throws -> Bool { try surveyor.undoWalk() != nil }

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
        let map = try BuildingMap.ofSurvey(name: floor, floors: [surveyed])
        return BuiltMap(
            file: try map.export(), expectedMedianM: accuracy?.medianM, expectedP90M: accuracy?.p90M)
    }
}
