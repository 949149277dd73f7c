"""The frames that every build of the card's firmware makes of one minute's walk; firmware/golden/README.md describes them."""

import struct
import unittest
from pathlib import Path

from fieldwalk import CardDecoder

GOLDEN = Path(__file__).resolve().parents[3] / "firmware" / "golden"


def lines(name):
    return (GOLDEN / name).read_text().splitlines()


def bits(value):
    return None if value is None else struct.pack(">f", value).hex()


def line(card_round):
    flags = (card_round.is_repeated, card_round.is_calibrated, card_round.just_woke, card_round.is_battery_low)
    thirds = [
        *card_round.vertical_field_ut,
        *card_round.horizontal_field_ut,
        *card_round.previous_strength_ut,
        *card_round.acceleration_max_m_s2,
        *card_round.acceleration_min_m_s2,
    ]
    words = [card_round.card_id, card_round.sequence, card_round.n_lost, *map(int, flags), card_round.battery_mv]
    words += [bits(value) for value in [*thirds, card_round.orientation_rad]]
    return " ".join("-" if word is None else str(word) for word in words)


class GoldenFrames(unittest.TestCase):
    def test_the_frames_of_the_card_are_read_as_in_rust(self):
        with CardDecoder() as decoder:
            frames = [bytes.fromhex(sent.split(" ")[1]) for sent in lines("walk-01.frames.txt")]
            rounds = [line(decoder.decode_advertisement(frame)) for frame in frames]
        self.assertEqual(len(rounds), 59)
        self.assertEqual(rounds, lines("walk-01.rounds.txt"))


if __name__ == "__main__":
    unittest.main()
