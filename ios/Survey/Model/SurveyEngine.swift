import Fieldwalk
import Foundation

/// What the app needs of a survey: `Surveyor` of Fieldwalk, and a stand-in in tests.
public protocol SurveyEngine: Sendable {
    /// The plan that is surveyed.
    func plan() -> PlanLines
    /// Takes in the walks that outlived the app, and tells of each what became of it; once, before any walk begins.
    func restore() throws -> [WalkSummary]
    /// Begins a walk; its name is for messages.
    func beginWalk(_ name: String) throws
    /// Takes samples in; those that come during a pause are dropped.
    func push(_ batch: Data) throws
    /// The surveyor stands at `point`.
    func tap(_ point: Point2, atNs timeNs: Int64) throws
    /// Takes the last waypoint of the walk back, and gives it; nothing when there is none.
    func undoTap() throws -> Point2?
    /// Pauses the walk.
    func pause(atNs timeNs: Int64) throws
    /// Goes on with it, from wherever the surveyor is now.
    func resume() throws
    /// Ends the walk.
    func endWalk() throws -> WalkSummary
    /// Drops the last of the walks that have ended; false when there is none.
    func undoWalk() throws -> Bool
    /// How the walk fares.
    func progress() throws -> WalkProgress
    /// What is covered so far.
    func coverage() throws -> CoverageGrid
    /// The map of all walks that have ended, as one file, and what it is worth; takes seconds.
    func build() throws -> BuiltMap
}

/// A floor plan as lines to draw, in metres: x to the right, y up.
public struct PlanLines: Sendable, Equatable {
    public var widthM: Double
    public var heightM: Double
    /// Rings of rooms and of the outline, each closed by its drawing.
    public var rings: [[Point2]]
    /// Walls and ways, open.
    public var lines: [[Point2]]

    public init(widthM: Double, heightM: Double, rings: [[Point2]] = [], lines: [[Point2]] = []) {
        (self.widthM, self.heightM, self.rings, self.lines) = (widthM, heightM, rings, lines)
    }
}

/// How a walk fares while it is walked.
public struct WalkProgress: Sendable, Equatable {
    /// Steps seen since it began or was resumed.
    public var nSteps: Int
    /// What to do about a phone that is not carried as a survey needs it, and about sensors that are missing.
    public var remedies: [String]

    public init(nSteps: Int, remedies: [String]) {
        (self.nSteps, self.remedies) = (nSteps, remedies)
    }
}

/// What became of a walk.
public struct WalkSummary: Sendable, Equatable {
    /// Whether the map can use it; one that it cannot use is dropped.
    public var isUsed: Bool
    /// What to do otherwise next time, or about a disk that did not take the walk; empty when all is well.
    public var remedy: String
    public var nSteps: Int
    public var routeM: Double

    public init(isUsed: Bool, remedy: String, nSteps: Int, routeM: Double) {
        (self.isUsed, self.remedy, self.nSteps, self.routeM) = (isUsed, remedy, nSteps, routeM)
    }
}

/// Which places of the floor the surveyed lines came near.
public struct CoverageGrid: Sendable, Equatable {
    public var openM2: Double
    public var coveredM2: Double
    /// Distance between nodes, in metres; the first lies at the origin.
    public var cellM: Double
    public var nColumns: Int
    public var nRows: Int
    /// A byte a node, along x first, from the lowest y: 0 nobody can stand there, 1 open and not covered, 2 covered.
    public var nodes: [UInt8]

    public init(openM2: Double, coveredM2: Double, cellM: Double, nColumns: Int, nRows: Int, nodes: [UInt8]) {
        (self.openM2, self.coveredM2, self.cellM) = (openM2, coveredM2, cellM)
        (self.nColumns, self.nRows, self.nodes) = (nColumns, nRows, nodes)
    }

    /// The covered part of what is open, from 0 to 1.
    public var share: Double { openM2 > 0 ? min(coveredM2 / openM2, 1) : 0 }
}

/// A finished map.
public struct BuiltMap: Sendable, Equatable {
    /// The map as one file.
    public var file: Data
    /// Median error to expect, in metres; nothing when no walk could be left out to tell it.
    public var expectedMedianM: Double?
    /// 90 of 100 errors are within this, in metres.
    public var expectedP90M: Double?

    public init(file: Data, expectedMedianM: Double?, expectedP90M: Double?) {
        (self.file, self.expectedMedianM, self.expectedP90M) = (file, expectedMedianM, expectedP90M)
    }
}
