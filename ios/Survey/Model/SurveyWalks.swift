import Fieldwalk
import Foundation

/// A survey as the app drives it: sensors into the engine while a walk is on, waypoints at taps, a picture of it all.
public actor SurveyWalks {
    private let engine: any SurveyEngine
    private let sensors: [any SensorSource]
    private let beacons: BeaconWatch?
    private let nowNs: @Sendable () -> Int64
    private var run: SensorRun?
    private var state = SurveyState()
    private var isRestored = false

    /// A survey with the walks that outlived the app: the first look takes them in.
    ///
    /// - Parameters:
    ///   - engine: surveys one floor
    ///   - sensors: where samples come from during a walk
    ///   - beacons: where beacons come from; what keeps them from being heard is among the remedies
    ///   - nowNs: the clock of the samples
    public init(
        engine: any SurveyEngine, sensors: [any SensorSource], beacons: BeaconWatch? = nil,
        nowNs: @escaping @Sendable () -> Int64 = SensorClock.nowNs
    ) {
        self.engine = engine
        self.sensors = sensors + (beacons.map { [$0] } ?? [])
        self.beacons = beacons
        self.nowNs = nowNs
        state.coverage = try? engine.coverage()
    }

    deinit {
        run?.end()
    }

    /// What to show.
    public func look() -> SurveyState {
        restore()
        if state.canEnd, let progress = try? engine.progress() {
            // The engine misses no radio: a survey needs none.
            let remedies = progress.remedies + [beacons?.trouble?.remedy].compactMap { $0 }
            (state.nSteps, state.remedies) = (progress.nSteps, remedies)
        } else {
            state.remedies = []
        }
        if let failure = run?.failure { state.message = remedy(of: failure) }
        return state
    }

    /// Begins a walk and starts the sensors; a walk whose sensors do not start has not begun.
    public func beginWalk() {
        restore()
        attempt(from: .idle) {
            try engine.beginWalk("walk \(state.nWalks + 1)")
            let engine = self.engine
            let run = SensorRun(sensors: sensors, latency: 0.25, push: { try engine.push($0) }, finish: { _ in })
            do {
                try run.begin()
            } catch {
                _ = try? engine.endWalk()
                throw error
            }
            self.run = run
            (state.phase, state.taps, state.nSteps) = (.walking, [], 0)
        }
    }

    /// The surveyor stands at `point`.
    public func tap(_ point: Point2) {
        attempt(from: .walking) {
            // What was sensed before the tap belongs to the line that ends here.
            run?.flush()
            try engine.tap(point, atNs: nowNs())
            state.taps.append(point)
            refreshCoverage()
        }
    }

    /// Takes the last waypoint back; with none left in the walk, nothing.
    public func undoTap() {
        attempt(from: .walking) {
            if try engine.undoTap() != nil {
                _ = state.taps.popLast()
                refreshCoverage()
            }
        }
    }

    /// Pauses the walk: the surveyor is held up or goes elsewhere.
    public func pause() {
        attempt(from: .walking) {
            run?.flush()
            try engine.pause(atNs: nowNs())
            state.phase = .paused
        }
    }

    /// Goes on with it from another place, which is the next waypoint.
    public func resume() {
        attempt(from: .paused) {
            // What was sensed during the pause is dropped.
            run?.flush()
            try engine.resume()
            (state.phase, state.taps) = (.walking, [])
        }
    }

    /// Ends the walk and stops the sensors.
    public func endWalk() {
        guard state.phase == .walking || state.phase == .paused else { return }
        attempt(from: state.phase) {
            run?.end()
            run = nil
            (state.phase, state.taps) = (.idle, [])
            take(try engine.endWalk())
            refreshCoverage()
        }
    }

    /// Drops the last walk that ended.
    public func undoWalk() {
        attempt(from: .idle) {
            guard try engine.undoWalk() else { return }
            state.nWalks -= 1
            state.routeM -= state.walkLengthsM.popLast() ?? 0
            refreshCoverage()
        }
    }

    /// Builds the map; nothing when that fails, and why is in the message.
    public func build() async -> BuiltMap? {
        guard state.phase == .idle, state.nWalks > 0 else { return nil }
        (state.phase, state.message) = (.building, nil)
        let engine = self.engine
        // Seconds of work, off this actor so that the screen can still look.
        let built = await Task.detached { Result { try engine.build() } }.value
        state.phase = .idle
        switch built {
        case .success(let map):
            return map
        case .failure(let error):
            state.message = remedy(of: error)
            return nil
        }
    }

    private func attempt(from phase: SurveyState.Phase, _ step: () throws -> Void) {
        guard state.phase == phase else { return }
        state.message = nil
        do { try step() } catch { state.message = remedy(of: error) }
    }

    private func refreshCoverage() {
        if let coverage = try? engine.coverage() { state.coverage = coverage }
    }

    private func restore() {
        if isRestored { return }
        isRestored = true
        attempt(from: .idle) {
            try engine.restore().forEach(take)
            refreshCoverage()
        }
    }

    private func take(_ summary: WalkSummary) {
        if !summary.remedy.isEmpty { state.message = summary.remedy }
        guard summary.isUsed else { return }
        state.nWalks += 1
        state.routeM += summary.routeM
        state.walkLengthsM.append(summary.routeM)
    }
}

/// What to tell the surveyor: of the engine's errors the remedy.
func remedy(of error: any Error) -> String {
    guard let error = error as? ApiError else { return "\(error)" }
    let fields = Mirror(reflecting: error).children.first.map { Mirror(reflecting: $0.value).children }
    let remedy = fields?.first { $0.label == "remedy" }?.value as? String
    return remedy ?? error.localizedDescription
}

/// What the screen shows.
public struct SurveyState: Sendable, Equatable {
    public enum Phase: Sendable, Equatable {
        case idle, walking, paused, building
    }

    public var phase = Phase.idle
    /// The waypoints since the walk began or was resumed.
    public var taps: [Point2] = []
    /// Steps since then.
    public var nSteps = 0
    /// What to do about a phone that is not carried as a survey needs it, and about sensors that are missing.
    public var remedies: [String] = []
    /// Walks that the map will use, and their length together.
    public var nWalks = 0
    public var routeM = 0.0
    /// The length of each.
    var walkLengthsM: [Double] = []
    public var coverage: CoverageGrid?
    /// What went wrong last, and what to do about it.
    public var message: String?

    public init() {}

    public var canBegin: Bool { phase == .idle }
    public var canTap: Bool { phase == .walking }
    public var canUndoTap: Bool { phase == .walking && !taps.isEmpty }
    public var canPause: Bool { phase == .walking }
    public var canResume: Bool { phase == .paused }
    public var canEnd: Bool { phase == .walking || phase == .paused }
    public var canUndoWalk: Bool { phase == .idle && nWalks > 0 }
    public var canBuild: Bool { phase == .idle && nWalks > 0 }

    /// Whether a walk is to be paused before the survey is left: its samples would be of another way.
    public var isPausedToLeave: Bool { phase == .walking }

    /// One line on how far the survey is.
    public var summary: String {
        let walks = nWalks == 1 ? "1 walk" : "\(nWalks) walks"
        let share = Int(((coverage?.share ?? 0) * 100).rounded(.down))
        return "\(walks), \(Int(routeM.rounded())) m, \(share) % covered"
    }

    /// What to do now.
    public var advice: String {
        switch phase {
        case .idle where nWalks == 0: "Begin a walk, then tap where you stand."
        case .idle: "Begin another walk, or build the map."
        case .walking where taps.isEmpty: "Tap where you stand."
        case .walking: "Walk in a straight line; tap where you turn or stop."
        case .paused: "Paused: resume, then tap where you stand."
        case .building: "Building the map…"
        }
    }
}
