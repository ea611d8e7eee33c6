"""Read back the tables that benchmarks print."""


def read_tables(text):
    """Return {title: [{column: cell}]} and check that every row fits its header."""
    result = {}
    title, header = None, None
    for line in text.splitlines():
        if line.startswith("### "):
            title, header = line[4:], None
        elif line.startswith("|"):
            cells = [cell.strip() for cell in line.strip("|").split("|")]
            if header is None:
                header = cells
                result[title] = []
                continue
            assert len(cells) == len(header), line
            if not set(line) <= set("|-: "):
                result[title].append(dict(zip(header, cells, strict=True)))
    return result
