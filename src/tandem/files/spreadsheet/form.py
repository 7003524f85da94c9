"""The words of the template, English and German. Every header here is one that `words.meaning`
understands; a test holds them to it.
"""

from __future__ import annotations

from typing import Literal, NamedTuple

from tandem.cell.walking import SPEED

Language = Literal["en", "de"]

SHEETS: dict[Language, dict[str, str]] = {
    "en": {
        "tasks": "Tasks",
        "operators": "Operators",
        "tools": "Tools",
        "zones": "Zones",
        "places": "Places",
        "walking": "Walking",
        "ergonomics": "Ergonomics",
        "sets": "Stress of sets",
        "cell": "Cell",
        "help": "Help",
    },
    "de": {
        "tasks": "Vorgänge",
        "operators": "Bediener",
        "tools": "Werkzeuge",
        "zones": "Bereiche",
        "places": "Orte",
        "walking": "Wege",
        "ergonomics": "Ergonomie",
        "sets": "Belastung der Mengen",
        "cell": "Zelle",
        "help": "Hilfe",
    },
}

HEADERS: dict[Language, dict[str, str]] = {
    "en": {
        "name": "task",
        "label": "description",
        "part": "part",
        "time": "time {who} [s]",
        "stress": "stress",
        "method": "method",
        "for whom": "for whom",
        "score": "score",
        "stress of": "stress {who}",
        "joint stress": "stress {who}",
        "joint stress of": "stress {human} with {others}",
        "after": "predecessors",
        "wait": "wait after [s]",
        "tool": "tool",
        "tool of": "tool {who}",
        "joint tool of": "tool {one} with {others}",
        "zone": "zone",
        "place": "place",
        "x": "x [m]",
        "y": "y [m]",
        "from": "from",
        "to": "to",
        "speed": "walking speed [m/s]",
        "difficulty": "difficulty {who}",
        "spread": "spread",
        "spread of": "spread {who}",
        "release": "earliest start [s]",
        "deadline": "latest end [s]",
        "same operator": "same operator as",
        "operator": "operator",
        "kind": "kind",
        "stress limit": "stress limit",
        "limits": "limits",
        "cycles": "products per shift",
        "setup": "setup [s]",
        "breaks": "breaks [s]",
        "holds": "holds",
        "capacity": "capacity",
        "apart": "keeps apart",
        "changeover": "changeover {who} [s]",
        "sets": "tasks",
        "cell name": "name",
        "human": "human",
        "robot": "robot",
        "machine": "machine",
    },
    "de": {
        "name": "Vorgang",
        "label": "Bezeichnung",
        "part": "Teil",
        "time": "Zeit {who} [s]",
        "stress": "Belastung",
        "method": "Methode",
        "for whom": "für wen",
        "score": "Wert",
        "stress of": "Belastung {who}",
        "joint stress": "Belastung {who}",
        "joint stress of": "Belastung {human} mit {others}",
        "after": "Vorgänger",
        "wait": "Wartezeit nach [s]",
        "tool": "Werkzeug",
        "tool of": "Werkzeug {who}",
        "joint tool of": "Werkzeug {one} mit {others}",
        "zone": "Bereich",
        "place": "Ort",
        "x": "x [m]",
        "y": "y [m]",
        "from": "von",
        "to": "nach",
        "speed": "Gehgeschwindigkeit [m/s]",
        "difficulty": "Schwierigkeit {who}",
        "spread": "Streuung",
        "spread of": "Streuung {who}",
        "release": "frühester Start [s]",
        "deadline": "spätestes Ende [s]",
        "same operator": "gleicher Bediener wie",
        "operator": "Bediener",
        "kind": "Art",
        "stress limit": "Belastungsgrenze",
        "limits": "Grenzwerte",
        "cycles": "Stück je Schicht",
        "setup": "Rüstzeit [s]",
        "breaks": "Pausen [s]",
        "holds": "hält",
        "capacity": "Anzahl",
        "apart": "hält getrennt",
        "changeover": "Wechselzeit {who} [s]",
        "sets": "Vorgänge",
        "cell name": "Name",
        "human": "Mensch",
        "robot": "Roboter",
        "machine": "Maschine",
    },
}


class OperatorColumn(NamedTuple):
    """A column of the sheet of operators.

    Attributes:
      word: its header, a key of `HEADERS`, which the vocabulary takes to mean `means`.
      key: of an operator in a cell file.
      holds: how a value in it is read and written.
      width: in characters.
    """

    word: str
    means: str
    key: str
    holds: Literal["kind", "text", "amount", "time", "breaks", "pairs", "limits"]
    width: int


OPERATOR_COLUMNS = (
    OperatorColumn("kind", "kind", "kind", "kind", 12),
    OperatorColumn("label", "label", "label", "text", 24),
    OperatorColumn("stress limit", "stress limit", "stress_limit", "amount", 16),
    OperatorColumn("limits", "limits", "limits", "limits", 30),
    OperatorColumn("setup", "changeover", "setup", "time", 14),
    OperatorColumn("breaks", "breaks", "breaks", "breaks", 22),
    OperatorColumn("tool", "tool", "tool", "text", 16),
    OperatorColumn("place", "place", "place", "text", 16),
    OperatorColumn("speed", "walking speed", SPEED, "amount", 14),
    OperatorColumn("holds", "holds", "holds", "pairs", 22),
)
"""What a workbook says of an operator, behind the name: what is read, and in which order the
template has it.
"""

HELP: dict[Language, tuple[tuple[str, str], ...]] = {
    "en": (
        (
            "What this is",
            (
                "One row a task, one column of times for each operator. Overwrite the example,"
                " save, then: tandem import FILE -o cell.yaml"
            ),
        ),
        ("task", "Short name or number, different for each task. Predecessors refer to it."),
        ("description", "What people call the step; shown in charts and instructions."),
        (
            "time ... [s]",
            (
                "How long this operator needs. 0 or empty: cannot do it. Other units: write [min],"
                " [1/100 min] or [TMU] into the header."
            ),
        ),
        (
            "time A + B [s]",
            (
                "A way of doing the task that needs both at once. Stress of it: a column 'stress A"
                " + B'."
            ),
        ),
        (
            "stress",
            (
                "Ergonomic stress on the human who does the task: EAWS points, or any number where"
                " more is worse. Per person: 'stress NAME'."
            ),
        ),
        ("predecessors", "Tasks that must have ended before: 1; 2. Empty: none."),
        (
            "tool, zone",
            "Optional. Details such as how many there are stand in sheets of their own.",
        ),
        (
            "wait after [s]",
            (
                "Optional: glue >= 40 <= 60 starts 40 to 60 s after glue has ended, glue (start) >="
                " 5 counts from its start. Several: with semicolons."
            ),
        ),
        (
            "tool NAME",
            (
                "Instead of 'tool', where it depends on who does the task: a column for each"
                " operator, 'tool A + B' for both together, 'tool A with B' for A then."
            ),
        ),
        (
            "place",
            (
                "Optional: where the task is done. Sheet Walking: seconds from place to place for"
                " each operator; or sheet Places: coordinates, and a walking speed in the sheet"
                " Operators."
            ),
        ),
        ("earliest start, latest end", "Optional, seconds since the start of the assembly."),
        (
            "Further columns",
            (
                "difficulty NAME, spread (coefficient of variation of the time), same operator as"
                " (a list of tasks), part."
            ),
        ),
        (
            "Sheet Operators",
            (
                "kind: human, robot or machine. Breaks: 300-600; 900-1000 in seconds since the"
                " start. Stress limit: the most for this human."
            ),
        ),
        (
            "limits",
            (
                "Sheet Operators: the most of further measures for this human: peak:reba = 7;"
                " time-above:reba:8 = 20; dose:lifft = 0.02. A dose needs the products per shift,"
                " sheet Cell."
            ),
        ),
        (
            "holds",
            "Sheet Operators: from and to which task a machine holds a part: load > unload; a > b.",
        ),
        (
            "keeps apart",
            "Sheet Zones: kinds that are never in the zone at once, such as human; robot.",
        ),
        (
            "setup [s]",
            (
                "Sheet Operators: what the operator needs once, at the start, to get ready. Empty:"
                " nothing."
            ),
        ),
        (
            "More operators",
            (
                "Copy a column of times, write the new name into its header, and add a row in the"
                " sheet Operators."
            ),
        ),
        (
            "Ergonomics",
            (
                "A sheet of that name may hold facts for ergonomic methods: a row for each task,"
                " method and side, with columns such as task, method, side, trunk [°], load [kg],"
                " repetitions per cycle; or the number that a method gave, as score."
            ),
        ),
    ),
    "de": (
        (
            "Wozu",
            (
                "Eine Zeile je Vorgang, eine Spalte Zeiten je Bediener. Beispiel überschreiben,"
                " speichern, dann: tandem import DATEI -o zelle.yaml"
            ),
        ),
        (
            "Vorgang",
            "Kurzer Name oder Nummer, für jeden Vorgang anders. Vorgänger beziehen sich darauf.",
        ),
        ("Bezeichnung", "Wie der Schritt heißt; steht in Diagrammen und Anweisungen."),
        (
            "Zeit ... [s]",
            (
                "Wie lange dieser Bediener braucht. 0 oder leer: kann es nicht. Sonst [min], [1/100"
                " min], [TMU] in die Überschrift."
            ),
        ),
        (
            "Zeit A + B [s]",
            "Eine Art, den Vorgang gemeinsam zu tun. Belastung dabei: Spalte 'Belastung A + B'.",
        ),
        (
            "Belastung",
            (
                "Ergonomische Belastung des Menschen, der es tut: EAWS-Punkte o. Ä., mehr ist"
                " schlechter. Je Person: 'Belastung NAME'."
            ),
        ),
        ("Vorgänger", "Vorgänge, die vorher beendet sein müssen: 1; 2. Leer: keine."),
        (
            "Werkzeug, Bereich",
            "Freiwillig. Einzelheiten wie die Anzahl stehen in eigenen Blättern.",
        ),
        (
            "Wartezeit nach [s]",
            (
                "Freiwillig: Kleben >= 40 <= 60 beginnt 40 bis 60 s nach dem Ende von Kleben,"
                " Kleben (Beginn) >= 5 zählt ab dessen Beginn. Mehrere: mit Semikolon."
            ),
        ),
        (
            "Werkzeug NAME",
            (
                "Statt 'Werkzeug', wo es davon abhängt, wer den Vorgang tut: eine Spalte je"
                " Bediener, 'Werkzeug A + B' für beide zusammen, 'Werkzeug A mit B' für A dabei."
            ),
        ),
        (
            "Ort",
            (
                "Freiwillig: wo der Vorgang getan wird. Blatt Wege: Sekunden von Ort zu Ort je"
                " Bediener; oder Blatt Orte: Koordinaten, und eine Gehgeschwindigkeit im Blatt"
                " Bediener."
            ),
        ),
        ("frühester Start, spätestes Ende", "Freiwillig, Sekunden seit Beginn der Montage."),
        (
            "Weitere Spalten",
            (
                "Schwierigkeit NAME, Streuung (Variationskoeffizient der Zeit), gleicher Bediener"
                " wie (Liste von Vorgängen), Teil."
            ),
        ),
        (
            "Blatt Bediener",
            (
                "Art: Mensch, Roboter oder Maschine. Pausen: 300-600; 900-1000 (Sekunden)."
                " Belastungsgrenze: das Meiste für diesen Menschen."
            ),
        ),
        (
            "Grenzwerte",
            (
                "Blatt Bediener: das Meiste von weiteren Maßen für diesen Menschen: peak:reba = 7;"
                " time-above:reba:8 = 20; dose:lifft = 0,02. Eine Dosis braucht die Stück je"
                " Schicht, Blatt Zelle."
            ),
        ),
        (
            "hält",
            "Blatt Bediener: von wo bis wo eine Maschine ein Teil hält: laden > entladen; a > b.",
        ),
        (
            "hält getrennt",
            "Blatt Bereiche: Arten, die nie zugleich darin sind, etwa Mensch; Roboter.",
        ),
        (
            "Rüstzeit [s]",
            "Blatt Bediener: was der Bediener einmal, am Anfang, zum Rüsten braucht. Leer: nichts.",
        ),
        (
            "Mehr Bediener",
            (
                "Eine Spalte Zeiten kopieren, den neuen Namen in die Überschrift schreiben, und"
                " eine Zeile im Blatt Bediener."
            ),
        ),
        (
            "Ergonomie",
            (
                "Ein Blatt dieses Namens kann Angaben für ergonomische Verfahren enthalten: eine"
                " Zeile je Vorgang, Methode und Seite, mit Spalten wie Vorgang, Methode, Seite,"
                " Rumpf [°], Last [kg], Wiederholungen je Zyklus; oder die Zahl, die ein Verfahren"
                " ergab, als Wert."
            ),
        ),
    ),
}

CHECKS: dict[Language, dict[str, str]] = {
    "en": {
        "number": "A number, 0 or more; empty or 0: cannot.",
        "name": "This name stands twice.",
        "see": "See the sheet",
    },
    "de": {
        "number": "Eine Zahl ab 0; leer oder 0: kann es nicht.",
        "name": "Dieser Name steht zweimal.",
        "see": "Siehe Blatt",
    },
}
"""What the sheet says when something else is typed."""

EXAMPLE = {
    "name": "Exemplary assembly (Kinat 2023, chapter 6)",
    "operators": {"robot": {"kind": "robot"}, "human": {"kind": "human"}},
    "tasks": {
        "1": {"time": {"robot": 9, "human": 10}, "stress": 10},
        "2": {"time": {"robot": 7, "human": 8}, "stress": 11},
        "3": {"time": {"human": 10}, "stress": 2},
        "4": {"time": {"robot": 2}, "after": ["1", "2"]},
        "5": {"time": {"robot": 4, "human": 2}, "stress": 4, "after": ["3"]},
        "6": {"time": {"robot": 10, "human": 3}, "stress": 1, "after": ["1", "2", "4"]},
        "7": {
            "time": {"robot": 2, "human": 4},
            "stress": 5,
            "after": ["1", "2", "3", "4", "5", "6"],
        },
    },
}
"""The filled example of the template."""
