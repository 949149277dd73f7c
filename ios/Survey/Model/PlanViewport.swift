import Fieldwalk

/// Where a plan lies on a screen: metres with y up, points with y down.
public struct PlanViewport: Sendable, Equatable {
    /// A place on the screen, in points from its top left corner.
    public struct Spot: Sendable, Equatable {
        public var x: Double
        public var y: Double
        public init(x: Double, y: Double) { (self.x, self.y) = (x, y) }
    }

    /// The plan's extent in metres, the screen's in points.
    public let planM: Spot
    public let screen: Spot
    /// Points a metre.
    public private(set) var scale: Double
    /// Which place of the plan is at the screen's middle.
    public private(set) var centre: Point2

    /// The whole plan, as large as it fits with a margin of a twentieth.
    public init(plan: PlanLines, screenWidth: Double, screenHeight: Double) {
        planM = Spot(x: max(plan.widthM, 0.1), y: max(plan.heightM, 0.1))
        screen = Spot(x: max(screenWidth, 1), y: max(screenHeight, 1))
        scale = 0.95 * min(screen.x / planM.x, screen.y / planM.y)
        centre = Point2(xM: planM.x / 2, yM: planM.y / 2)
    }

    public func spot(of point: Point2) -> Spot {
        Spot(x: screen.x / 2 + scale * (point.xM - centre.xM), y: screen.y / 2 - scale * (point.yM - centre.yM))
    }

    /// The place of the plan at `spot`; nothing beside the plan.
    public func point(at spot: Spot) -> Point2? {
        let point = unbounded(at: spot)
        let isOnPlan = (0...planM.x).contains(point.xM) && (0...planM.y).contains(point.yM)
        return isOnPlan ? point : nil
    }

    /// `factor` times as large, the place under `spot` staying where it is; from the whole plan to 200 points a metre.
    public func zoomed(by factor: Double, about spot: Spot) -> Self {
        guard factor.isFinite, factor > 0 else { return self }
        var zoomed = self
        let whole = 0.95 * min(screen.x / planM.x, screen.y / planM.y)
        zoomed.scale = min(max(scale * factor, whole), max(200, whole))
        let anchor = unbounded(at: spot), moved = zoomed.unbounded(at: spot)
        zoomed.centre = Point2(
            xM: centre.xM + anchor.xM - moved.xM, yM: centre.yM + anchor.yM - moved.yM)
        return zoomed.kept()
    }

    /// Dragged by so many points; the plan's middle of the screen stays on the plan.
    public func dragged(x: Double, y: Double) -> Self {
        var dragged = self
        dragged.centre = Point2(xM: centre.xM - x / scale, yM: centre.yM + y / scale)
        return dragged.kept()
    }

    private func unbounded(at spot: Spot) -> Point2 {
        Point2(xM: centre.xM + (spot.x - screen.x / 2) / scale, yM: centre.yM - (spot.y - screen.y / 2) / scale)
    }

    private func kept() -> Self {
        var kept = self
        kept.centre = Point2(xM: min(max(centre.xM, 0), planM.x), yM: min(max(centre.yM, 0), planM.y))
        return kept
    }
}
