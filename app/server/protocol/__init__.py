"""The messages between browser and server; TypeScript's types of them are written from these."""
