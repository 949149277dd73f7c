import Fieldwalk
import Testing

@testable import FieldwalkSurvey

struct PlanViewportTests {
    private let viewport = PlanViewport(
        plan: PlanLines(widthM: 40, heightM: 20), screenWidth: 400, screenHeight: 800)

    @Test func theWholePlanFitsAndItsTopIsUp() {
        #expect(viewport.scale == 9.5)
        let lowerLeft = viewport.spot(of: Point2(xM: 0, yM: 0))
        let upperRight = viewport.spot(of: Point2(xM: 40, yM: 20))
        #expect(abs(lowerLeft.x - 10) < 1e-9 && abs(lowerLeft.y - 495) < 1e-9)
        #expect(abs(upperRight.x - 390) < 1e-9 && abs(upperRight.y - 305) < 1e-9)
    }

    @Test func aTapIsThePlaceThatIsDrawnThere() throws {
        let moved = viewport.zoomed(by: 3, about: .init(x: 50, y: 700)).dragged(x: -31, y: 12)
        let point = Point2(xM: 12.5, yM: 3.25)
        let found = try #require(moved.point(at: moved.spot(of: point)))
        #expect(abs(found.xM - point.xM) < 1e-9 && abs(found.yM - point.yM) < 1e-9)
    }

    @Test func besideThePlanThereIsNoPlace() {
        #expect(viewport.point(at: .init(x: 5, y: 400)) == nil)
        #expect(viewport.point(at: .init(x: 200, y: 300)) == nil)
        #expect(viewport.point(at: .init(x: 200, y: 400)) != nil)
    }

    @Test func zoomingKeepsThePlaceUnderTheFingersAndHasBounds() throws {
        let fingers = PlanViewport.Spot(x: 150, y: 420)
        let before = try #require(viewport.point(at: fingers))
        let after = try #require(viewport.zoomed(by: 2.5, about: fingers).point(at: fingers))
        #expect(abs(before.xM - after.xM) < 1e-9 && abs(before.yM - after.yM) < 1e-9)
        #expect(viewport.zoomed(by: 0.01, about: fingers).scale == viewport.scale)
        #expect(viewport.zoomed(by: 1e6, about: fingers).scale == 200)
        for factor in [0, -1, Double.nan, .infinity] {
            #expect(viewport.zoomed(by: factor, about: fingers) == viewport)
        }
    }

    @Test func thePlanCannotBeDraggedAway() {
        let away = viewport.dragged(x: 1e6, y: -1e6)
        #expect(away.centre == Point2(xM: 0, yM: 0))
        #expect(viewport.dragged(x: -1e6, y: 1e6).centre == Point2(xM: 40, yM: 20))
    }

    @Test func aPlanWithoutExtentHarmsNothing() {
        let empty = PlanViewport(plan: PlanLines(widthM: 0, heightM: 0), screenWidth: 0, screenHeight: 0)
        #expect(empty.scale.isFinite && empty.scale > 0)
    }
}
