import Testing

@testable import FieldwalkSurvey

struct CoverageImageTests {
    @Test func theHighestRowOfTheGridIsTheFirstOfTheImage() throws {
        let grid = CoverageGrid(
            openM2: 4, coveredM2: 1, cellM: 0.5, nColumns: 3, nRows: 2, nodes: [0, 1, 2, 2, 0, 1])
        let image = try #require(CoverageImage(grid))
        let opacities = stride(from: 3, to: image.rgba.count, by: 4).map { image.rgba[$0] }
        #expect(opacities == [96, 0, 64, 0, 64, 96])
        #expect(image.widthM == 1.5 && image.heightM == 1)
        // Multiplied by the opacity: no colour is above it.
        for pixel in stride(from: 0, to: image.rgba.count, by: 4) {
            #expect(image.rgba[pixel..<pixel + 3].allSatisfy { $0 <= image.rgba[pixel + 3] })
        }
    }

    @Test func aGridThatIsNotAsLargeAsItSaysIsNoImage() {
        let torn = CoverageGrid(openM2: 4, coveredM2: 1, cellM: 0.5, nColumns: 3, nRows: 2, nodes: [0, 1])
        #expect(CoverageImage(torn) == nil)
        #expect(CoverageImage(CoverageGrid(openM2: 0, coveredM2: 0, cellM: 1, nColumns: 0, nRows: 0, nodes: [])) == nil)
    }

    @Test func theShareIsFromNothingToAll() {
        #expect(CoverageGrid(openM2: 0, coveredM2: 0, cellM: 1, nColumns: 0, nRows: 0, nodes: []).share == 0)
        #expect(CoverageGrid(openM2: 8, coveredM2: 2, cellM: 1, nColumns: 0, nRows: 0, nodes: []).share == 0.25)
        #expect(CoverageGrid(openM2: 8, coveredM2: 9, cellM: 1, nColumns: 0, nRows: 0, nodes: []).share == 1)
    }

    @Test(arguments: [("F1", "F1.map.tar"), ("../Ground floor", "Ground-floor.map.tar"), ("地下", "floor.map.tar")])
    func anExportHasAPlainName(floor: String, name: String) {
        #expect(exportName(floor: floor) == name)
    }
}
