"""The words of a SERCOS drive as both ends take them: idents, elements, error codes, commands."""
